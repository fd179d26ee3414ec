// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <future>
#include <vector>

#include "sgs/input/input.h"
#include "sgs/run/frame_recorder.h"
#include "sgs/run/run_observer.h"
#include "sgs/runfolder/run_folder.h"

namespace sgs::run {

/// Serves the wishes of whoever watches a run while it goes on (RunObserver::take_save(),
/// take_recording()). Belongs to the thread of the session; what takes time has a thread of its
/// own.
class LiveDesk {
 public:
  /// `drops`: frames that the disk cannot take are left out of a recording; else the run waits. All
  /// of the others live longer.
  LiveDesk(const Input& input, bool drops, const RunFolder& folder, slam::Session& session,
           RunObserver& observer);

  FrameRecorder& recorder() { return recorder_; }
  /// Begins a recording in `folder`; an error where that cannot be.
  Status record(const std::filesystem::path& folder);
  /// To be called before each frame, and many times a second while the run is held.
  void serve();
  /// After the last frame: ends the recording, and gives what could not be written of any.
  std::vector<Error> close();
  /// Where the newest recording is; empty: there was none.
  std::filesystem::path recording() const;

 private:
  void save();
  void keep_samples();
  std::filesystem::path free_folder() const;

  const Input& input_;
  const RunFolder& folder_;
  slam::Session& session_;
  RunObserver& observer_;
  FrameRecorder recorder_;
  bool save_wanted_ = false;
  std::vector<std::filesystem::path> recordings_;
  std::future<void> saving_;
};

}  // namespace sgs::run
