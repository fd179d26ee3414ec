// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "sgs/core/enum_names.h"
#include "sgs/core/error.h"

namespace sgs::run {

/// How far a run has come, as its folder says.
enum class Stage {
  kRunning,      ///< begun; where nobody holds the folder any more, it was killed
  kFinished,     ///< every result is there, scores apart
  kInterrupted,  ///< ended early by request or by a fault; what was done is there
};
constexpr auto enum_names(Stage) {
  using enum Stage;
  return std::to_array<EnumName<Stage>>(
      {{kRunning, "running"}, {kFinished, "finished"}, {kInterrupted, "interrupted"}});
}

/// state.toml of a run folder, and whether its owner is still at work.
struct RunState {
  Stage stage = Stage::kFinished;
  std::string owner;       ///< process, machine and time of its start; empty where it is not known
  int frames = 0;          ///< handled, bad ones included; known once the run has ended
  std::string reason;      ///< why it was interrupted
  bool held = false;       ///< a process has the folder's lock; not in the file
  bool live = false;       ///< frames came at the camera's rate or from a stream: not again
  std::string input = {};  ///< while it runs: what the input suffers from, or nothing
  std::string recording = {};  ///< folder that its frames were kept in, from the run's; or empty

  /// The run was killed, or is still going on: its files are journals and checkpoints.
  bool unfinished() const { return stage == Stage::kRunning; }
  /// One word for scores: finished, interrupted, running or killed.
  std::string word() const;
  /// A sentence about a run that is not finished; empty for one that is.
  std::string sentence(const std::filesystem::path& folder) const;
};

/// Text of state.toml.
std::string state_text(const RunState& state);
/// Reads a folder's state. Folders from before there was one count as finished.
Result<RunState> load_state(const std::filesystem::path& folder);

}  // namespace sgs::run
