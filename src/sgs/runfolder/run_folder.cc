// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/runfolder/run_folder.h"

#include <fmt/chrono.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <ctime>
#include <regex>

#include "sgs/core/log.h"
#include "sgs/io/atomic_file.h"
#include "sgs/runfolder/checkpoint_folders.h"
#include "sgs/runfolder/run_files.h"

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

bool is_there(const fs::path& path) {
  std::error_code unreadable;
  return fs::exists(path, unreadable);
}

/// Pictures of `sgs run` and `sgs render`; nothing else in renders/ is touched.
bool is_picture(const std::string& name) {
  static const std::regex pattern(
      R"(\d{6,}_(truth|render|error|before)\.png|(render|depth)_\d{6,}\.png)");
  return std::regex_match(name, pattern);
}

/// What is there of the files that a run makes.
std::vector<fs::path> results_in(const fs::path& folder) {
  std::vector<fs::path> found;
  for (const char* name : files::kResults) {
    if (is_there(folder / name)) found.push_back(folder / name);
  }
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(folder / files::kRenders, none)) {
    if (is_picture(entry.path().filename().string())) found.push_back(entry.path());
  }
  for (fs::path& part : checkpoints_in(folder)) found.push_back(std::move(part));
  return found;
}

/// What a run that was killed while it wrote left beside its files.
std::vector<fs::path> half_written_in(const fs::path& folder) {
  std::vector<fs::path> found;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(folder, none)) {
    const std::string name = entry.path().filename().string();
    const auto is_of = [&](const char* file) { return io::is_temporary_of(name, file); };
    const bool ours = std::any_of(files::kResults.begin(), files::kResults.end(), is_of) ||
                      is_of(files::kState) || is_of(files::kLock) || is_of(files::kCheckpoint);
    if (ours) found.push_back(entry.path());
  }
  for (const auto& entry : fs::directory_iterator(folder / files::kRenders, none)) {
    const fs::path name = entry.path().filename();
    // From 000012_truth.png.77.tmp to the picture's own name.
    const std::string file = name.stem().stem().string();
    const bool ours = is_picture(file) || file == fs::path(files::kPictures).filename();
    if (ours && io::is_temporary_of(name.string(), file)) found.push_back(entry.path());
  }
  return found;
}

Status remove_all(const std::vector<fs::path>& paths) {
  for (const fs::path& old : paths) {
    std::error_code error;
    fs::remove(old, error);
    if (error) {
      return fail(ErrorCode::kIo,
                  fmt::format("cannot remove {}: {}", old.string(), error.message()),
                  "it belongs to an earlier run: choose another folder");
    }
  }
  return {};
}

/// A folder of recorded images has files of the same names, and they are not ours to remove.
Status check_is_free(const fs::path& folder) {
  if (is_there(folder / files::kState) || is_there(folder / files::kLock)) return {};
  const auto config = io::read_file(folder / files::kConfig);
  if (config && config->starts_with("# Written by sgs")) return {};
  const auto found = results_in(folder);
  if (found.empty()) return {};
  return fail(ErrorCode::kInvalidArgument,
              fmt::format("{} has a file {} and is no run folder", folder.string(),
                          found.front().filename().string()),
              "choose another folder: a run removes what an earlier one left");
}

}  // namespace

Result<RunFolder> RunFolder::create(const fs::path& path) {
  RunFolder folder(path);
  SGS_RETURN_IF_ERROR(check_is_free(path));
  SGS_ASSIGN_OR_RETURN(folder.lock_, FolderLock::take(path));
  SGS_RETURN_IF_ERROR(remove_all(half_written_in(path)));
  SGS_RETURN_IF_ERROR(folder.begin());
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

Result<RunFolder> RunFolder::resume(const fs::path& path) {
  SGS_ASSIGN_OR_RETURN(RunFolder folder, open(path));
  SGS_ASSIGN_OR_RETURN(folder.lock_, FolderLock::take(path));
  SGS_RETURN_IF_ERROR(remove_all(half_written_in(path)));
  folder.resumed_ = true;
  return folder;
}

Status RunFolder::mark_resumed(bool calibration_given) {
  SGS_RETURN_IF_ERROR(io::write_file(path_ / files::kState, state_text(beginning())));
  std::vector<fs::path> ends = {path_ / files::kMetrics, path_ / files::kReport,
                                path_ / files::kTimings, path_ / files::kPictures,
                                path_ / files::kRefine};
  if (!calibration_given) ends.push_back(path_ / files::kCalibration);
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(path_ / files::kRenders, none)) {
    if (is_picture(entry.path().filename().string())) ends.push_back(entry.path());
  }
  return remove_all(ends);
}

Status RunFolder::mark_live() {
  live_ = true;
  return io::write_file(path_ / files::kState, state_text(beginning()));
}

void RunFolder::note_recording(const fs::path& folder) {
  std::error_code none;
  const fs::path here = fs::absolute(path_, none).lexically_normal();
  const fs::path there = fs::absolute(folder, none).lexically_normal();
  // What lies inside moves with the folder.
  const fs::path inside = there.lexically_relative(here);
  const bool outside = inside.empty() || *inside.begin() == "..";
  recording_ = (outside ? there : inside).string();
}

Result<RunFolder> RunFolder::open(const fs::path& path) {
  std::error_code error;
  if (!fs::is_directory(path, error)) {
    return fail(ErrorCode::kNotFound, fmt::format("{} is not a folder", path.string()),
                "give a run folder made by `sgs run`");
  }
  return RunFolder(path);
}

Status RunFolder::begin() {
  // Marked before anything is removed, and anything new is written after that: at no moment do old
  // and new files look like one run.
  SGS_RETURN_IF_ERROR(io::write_file(path_ / files::kState, state_text(beginning())));
  SGS_RETURN_IF_ERROR(remove_all(results_in(path_)));
  // Finding out now that nothing can be written here beats finding out after the run.
  SGS_RETURN_IF_ERROR(io::write_file(path_ / files::kLog, ""));
  return io::make_folder(path_ / files::kRenders);
}

RunState RunFolder::beginning() const {
  RunState state;
  state.stage = Stage::kRunning;
  if (lock_) state.owner = lock_->owner();
  state.live = live_;
  state.recording = recording_;
  return state;
}

void RunFolder::note_input(const std::string& trouble) const {
  if (!lock_ || !lock_->ensure()) return;
  RunState state = beginning();
  state.input = trouble;
  (void)io::write_file(path_ / files::kState, state_text(state), io::Durability::kRelaxed);
}

void RunFolder::end(Stage stage, std::size_t frames, const std::string& reason) {
  RunState state = beginning();
  state.stage = failures_.empty() ? stage : Stage::kInterrupted;
  state.frames = static_cast<int>(frames);
  state.reason = reason;
  if (!failures_.empty() && reason.empty()) {
    state.reason = rescued_to_.empty() ? "not everything could be written"
                                       : "what did not fit here is in " + rescued_to_.string();
  }
  save_text(files::kState, state_text(state));
  if (state.stage != Stage::kFinished) return;
  if (const auto removed = remove_all(checkpoints_in(path_)); !removed) {
    log().warn("{}", removed.error().text());  // the results are there all the same
  }
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
