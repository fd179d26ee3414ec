// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/run/run_folder.h"

#include <fcntl.h>
#include <fmt/chrono.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <ctime>

#include "sgs/core/log.h"
#include "sgs/io/atomic_file.h"
#include "sgs/run/run_files.h"

namespace fs = std::filesystem;

namespace sgs::run {
namespace {

std::string file_name(std::string name) {
  std::replace_if(
      name.begin(), name.end(),
      [](unsigned char c) { return std::isalnum(c) == 0 && c != '-' && c != '_' && c != '.'; },
      '_');
  return name;
}

std::string text_line(std::string text) {
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text;
}

}  // namespace

Result<RunFolder> RunFolder::create(const fs::path& path) {
  RunFolder folder(path);
  SGS_RETURN_IF_ERROR(io::make_folder(folder.path_));
  SGS_RETURN_IF_ERROR(folder.lock());
  // Finding out now that nothing can be written here beats finding out after the run.
  SGS_RETURN_IF_ERROR(io::write_file(folder.path_ / files::kLog, ""));
  SGS_RETURN_IF_ERROR(io::make_folder(folder.path_ / files::kRenders));
  return folder;
}

Result<RunFolder> RunFolder::create_below(const fs::path& parent, const std::string& name) {
  const std::string base =
      fmt::format("{:%Y%m%d-%H%M%S}-{}", fmt::localtime(std::time(nullptr)), file_name(name));
  fs::path path = parent / base;
  std::error_code ignored;
  for (int i = 2; fs::exists(path, ignored); ++i) path = parent / fmt::format("{}-{}", base, i);
  return create(path);
}

Result<RunFolder> RunFolder::open(const fs::path& path) {
  std::error_code error;
  if (!fs::is_directory(path, error)) {
    return fail(ErrorCode::kNotFound, fmt::format("{} is not a folder", path.string()),
                "give a run folder made by `sgs run`");
  }
  return RunFolder(path);
}

// The system lets go of the lock when the process ends, however it ends.
Status RunFolder::lock() {
  const fs::path path = path_ / files::kLock;
  const int fd = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (fd < 0) {
    return fail(ErrorCode::kIo,
                fmt::format("cannot write {}: {}", path.string(), std::strerror(errno)),
                "choose another folder");
  }
  lock_ = std::shared_ptr<const int>(new int(fd), [](const int* held) {
    ::close(*held);
    delete held;
  });
  // Some network file systems know no locks: they are no reason not to run.
  if (::flock(fd, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    const auto owner = io::read_file(path).value_or("another process");
    return fail(ErrorCode::kIo,
                fmt::format("{} is being written by {}", path_.string(), text_line(owner)),
                "wait for it, or choose another folder");
  }
  const std::string owner =
      fmt::format("process {}, started {:%F %T}\n", ::getpid(), fmt::localtime(std::time(nullptr)));
  if (::ftruncate(fd, 0) != 0 || ::pwrite(fd, owner.data(), owner.size(), 0) < 0) {
    log().debug("{} could not be written: {}", path.string(), std::strerror(errno));
  }
  return {};
}

void RunFolder::save_text(const std::string& name, std::string_view text) {
  save(name, [text](const fs::path& path) { return io::write_file(path, text); });
}

Result<fs::path> RunFolder::rescue_folder() {
  if (rescue_.empty()) {
    std::error_code error;
    fs::path base = fs::temp_directory_path(error);
    if (error) base = fs::current_path(error);
    // A name that nobody can foresee and a folder that nobody else can open.
    std::string name = (base / "sgs-rescue-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) {
      return fail(ErrorCode::kIo, fmt::format("cannot make a folder in {}", base.string()),
                  "free space there, or set TMPDIR to a folder with space");
    }
    rescue_ = name;
  }
  return rescue_;
}

void point_latest_to(const fs::path& parent, const fs::path& folder) {
  std::error_code error;
  fs::create_directories(parent, error);
  const fs::path link = parent / "latest";
  if (fs::is_symlink(link, error)) fs::remove(link, error);
  const fs::path target =
      fs::proximate(fs::absolute(folder, error), fs::absolute(parent, error), error);
  fs::create_directory_symlink(target, link, error);
  if (error) log().warn("{} could not be set: {}", link.string(), error.message());
}

}  // namespace sgs::run
