// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/runfolder/checkpoint_folders.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include "sgs/io/atomic_file.h"
#include "sgs/runfolder/run_files.h"

namespace sgs::run {
namespace fs = std::filesystem;
namespace {

/// N of the name checkpoint.N; nothing else is one, a path least of all.
std::optional<int> checkpoint_number(std::string_view name) {
  const std::string_view prefix = files::kCheckpointFolder;
  if (!name.starts_with(prefix)) return std::nullopt;
  name.remove_prefix(prefix.size());
  int number = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
  const bool whole = error == std::errc() && end == name.data() + name.size() && number > 0;
  return whole ? std::optional(number) : std::nullopt;
}

std::string checkpoint_name(int number) {
  return files::kCheckpointFolder + std::to_string(number);
}

/// Number of the checkpoint that the folder names; 0 = none.
int named_checkpoint(const fs::path& run_folder) {
  constexpr std::int64_t kLongest_bytes = 256;
  const auto text = io::read_file(run_folder / files::kCheckpoint, kLongest_bytes);
  return text ? checkpoint_number(text->substr(0, text->find('\n'))).value_or(0) : 0;
}

/// Folders of checkpoints, whether they count or not.
std::vector<std::pair<int, fs::path>> folders_in(const fs::path& run_folder) {
  std::vector<std::pair<int, fs::path>> found;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(run_folder, none)) {
    const auto number = checkpoint_number(entry.path().filename().string());
    std::error_code unreadable;
    if (number && entry.is_directory(unreadable)) found.emplace_back(*number, entry.path());
  }
  std::sort(found.begin(), found.end());
  return found;
}

/// A folder's files that are ours, then the folder.
void append_parts(const fs::path& folder, std::vector<fs::path>& parts) {
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(folder, none)) {
    const std::string name = entry.path().filename().string();
    const bool ours = std::any_of(
        files::kOfCheckpoint.begin(), files::kOfCheckpoint.end(),
        [&](const char* file) { return name.starts_with(file); });  // temporary ones, too
    if (ours) parts.push_back(entry.path());
  }
  parts.push_back(folder);
}

}  // namespace

CheckpointFolders::CheckpointFolders(fs::path run_folder)
    : run_folder_(std::move(run_folder)), number_(named_checkpoint(run_folder_)) {
  for (const auto& [number, folder] : folders_in(run_folder_)) number_ = std::max(number_, number);
}

Status CheckpointFolders::write(const std::vector<NamedWriter>& written) {
  const std::string name = checkpoint_name(++number_);
  SGS_RETURN_IF_ERROR(io::make_folder(run_folder_ / name));
  Status status;
  for (const NamedWriter& file : written) {
    if (status) status = file.write(run_folder_ / name / file.name);
  }
  if (status) status = io::write_file(run_folder_ / files::kCheckpoint, name + "\n");
  // What does not count any more goes; so does what did not come to count.
  const int counts = status ? number_ : named_checkpoint(run_folder_);
  for (const auto& [number, folder] : folders_in(run_folder_)) {
    if (number == counts) continue;
    std::vector<fs::path> parts;
    append_parts(folder, parts);
    std::error_code ignored;
    for (const fs::path& part : parts) fs::remove(part, ignored);
  }
  return status;
}

fs::path newest_checkpoint(const fs::path& run_folder) {
  const int number = named_checkpoint(run_folder);
  return number > 0 ? run_folder / checkpoint_name(number) : run_folder;
}

std::vector<fs::path> checkpoints_in(const fs::path& run_folder) {
  std::vector<fs::path> parts;
  std::error_code unreadable;
  const fs::path name = run_folder / files::kCheckpoint;
  if (fs::exists(name, unreadable)) parts.push_back(name);
  for (const auto& [number, folder] : folders_in(run_folder)) append_parts(folder, parts);
  return parts;
}

}  // namespace sgs::run
