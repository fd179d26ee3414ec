// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "sgs/core/error.h"
#include "sgs/runfolder/folder_lock.h"
#include "sgs/runfolder/named_writer.h"
#include "sgs/runfolder/run_state.h"

namespace sgs::run {

/// The folder that keeps everything about one run. What cannot be written there (full disk,
/// permissions lost on the way) goes to a rescue folder instead, so that nothing computed is lost.
class RunFolder {
 public:
  /// Creates the folder `path` and holds it until this object is gone: a second run that wants the
  /// same folder fails and is told who has it. From now on the folder says that its run is not
  /// finished. What an earlier run left there is removed first, so that old and new never mix; a
  /// folder that is no run folder and has files of these names is refused.
  static Result<RunFolder> create(const std::filesystem::path& path);
  /// Creates `parent`/<time>-<name>.
  static Result<RunFolder> create_below(const std::filesystem::path& parent,
                                        const std::string& name);

  /// The folder of a run that was killed or interrupted, to go on with it. It is held as by
  /// create(), and stays as it is until mark_resumed().
  static Result<RunFolder> resume(const std::filesystem::path& path);
  /// An existing run folder, to add to.
  static Result<RunFolder> open(const std::filesystem::path& path);

  const std::filesystem::path& path() const { return path_; }
  /// Calls `write` with the path of `name` in this folder; when that fails, once more with a path
  /// in the rescue folder, and remembers the failure.
  template <class Writer>
  void save(const std::string& name, Writer&& write) {
    const auto attempt = [&write](const std::filesystem::path& path) -> Status {
      try {
        return write(path);
      } catch (...) {
        Error error = current_error();
        error.message = fmt::format("cannot write {}: {}", path.string(), error.message);
        return tl::unexpected(error);
      }
    };
    // A folder that was removed is made again; one that another run has taken is left alone.
    const Status ours = lock_ ? lock_->ensure() : Status{};
    const Status first = ours ? attempt(path_ / name) : ours;
    if (first) return;
    failures_.push_back(first.error());
    const auto rescue = rescue_folder();
    if (!rescue) return failures_.push_back(rescue.error());
    if (const Status second = attempt(*rescue / name)) {
      rescued_to_ = *rescue;
    } else {
      failures_.push_back(second.error());
    }
  }
  /// Notes a failure to write something outside of the folder.
  void note_failure(const Error& error) { failures_.push_back(error); }
  void save_text(const std::string& name, std::string_view text);
  /// While the run goes on: what its input suffers from, or nothing, for state.toml. What cannot be
  /// written is no failure of the run.
  void note_input(const std::string& trouble) const;
  /// The run has ended: says so in state.toml. Not everything having found its place here is an
  /// interruption, too.
  void end(Stage stage, std::size_t frames, const std::string& reason);

  /// Says that the run is going on again. What was made of its end is removed, which is what the
  /// first end of the interrupted run made beside its results: scores, pictures, the report, and
  /// the calibration unless it was given with the input.
  Status mark_resumed(bool calibration_given);
  /// Whether the folder is from resume().
  bool resumed() const { return resumed_; }
  /// The run goes on at the camera's rate: state.toml says so from now on.
  Status mark_live();
  /// Frames are kept in this folder: state.toml says so from when it is next written.
  void note_recording(const std::filesystem::path& folder);

  /// The state with which the folder began.
  RunState beginning() const;
  /// Null for a folder that was only opened.
  const std::shared_ptr<FolderLock>& lock() const { return lock_; }
  /// Everything that could not be written where it belongs.
  const std::vector<Error>& failures() const { return failures_; }
  /// Where files went that did not fit into path(); empty when all is well.
  const std::filesystem::path& rescued_to() const { return rescued_to_; }

 private:
  explicit RunFolder(std::filesystem::path path) : path_(std::move(path)) {}
  Result<std::filesystem::path> rescue_folder();

  Status begin();

  std::shared_ptr<FolderLock> lock_;
  bool resumed_ = false, live_ = false;
  std::string recording_;
  std::filesystem::path path_;
  std::filesystem::path rescue_;      // empty until it is needed
  std::filesystem::path rescued_to_;  // the same, once something went there
  std::vector<Error> failures_;
};

/// Makes the link `parent`/latest point to a run folder; a failure is only logged.
void point_latest_to(const std::filesystem::path& parent, const std::filesystem::path& folder);

}  // namespace sgs::run
