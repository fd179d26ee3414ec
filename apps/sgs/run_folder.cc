// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "run_folder.h"

#include <fmt/chrono.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <ctime>

#include "sgs/core/log.h"
#include "sgs/io/atomic_file.h"

namespace fs = std::filesystem;

namespace sgs::app {
namespace {

std::string file_name(std::string name) {
  std::replace_if(
      name.begin(), name.end(),
      [](unsigned char c) { return std::isalnum(c) == 0 && c != '-' && c != '_' && c != '.'; },
      '_');
  return name;
}

fs::path fresh_folder(const std::string& name) {
  const std::string base =
      fmt::format("{:%Y%m%d-%H%M%S}-{}", fmt::localtime(std::time(nullptr)), file_name(name));
  fs::path path = fs::path("runs") / base;
  std::error_code ignored;
  for (int i = 2; fs::exists(path, ignored); ++i) {
    path = fs::path("runs") / fmt::format("{}-{}", base, i);
  }
  return path;
}

void point_latest_to(const fs::path& folder) {
  std::error_code error;
  fs::create_directories("runs", error);
  const fs::path link = fs::path("runs") / "latest";
  if (fs::is_symlink(link, error)) fs::remove(link, error);
  const fs::path target =
      fs::proximate(fs::absolute(folder, error), fs::absolute("runs", error), error);
  fs::create_directory_symlink(target, link, error);
  if (error) log().warn("runs/latest could not be set: {}", error.message());
}

}  // namespace

Result<RunFolder> RunFolder::create(const fs::path& requested, const std::string& name) {
  RunFolder folder(requested.empty() ? fresh_folder(name) : requested);
  SGS_RETURN_IF_ERROR(io::make_folder(folder.path_));
  // Finding out now that nothing can be written here beats finding out after the run.
  SGS_RETURN_IF_ERROR(io::write_file(folder.path_ / "log.txt", ""));
  SGS_RETURN_IF_ERROR(io::make_folder(folder.path_ / "renders"));
  point_latest_to(folder.path_);
  return folder;
}

Result<RunFolder> RunFolder::open(const fs::path& path) {
  std::error_code error;
  if (!fs::is_directory(path, error)) {
    return fail(ErrorCode::kNotFound, fmt::format("{} is not a folder", path.string()),
                "give a run folder made by `sgs run`");
  }
  return RunFolder(path);
}

void RunFolder::save_text(const std::string& name, std::string_view text) {
  save(name, [text](const fs::path& path) { return io::write_file(path, text); });
}

Result<fs::path> RunFolder::rescue_folder() {
  if (rescue_.empty()) {
    std::error_code error;
    fs::path base = fs::temp_directory_path(error);
    if (error) base = fs::current_path(error);
    const fs::path rescue = base / fmt::format("sgs-rescue-{}", getpid());
    SGS_RETURN_IF_ERROR(io::make_folder(rescue));
    rescue_ = rescue;
  }
  return rescue_;
}

}  // namespace sgs::app
