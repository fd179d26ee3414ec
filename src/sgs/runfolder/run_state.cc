// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/runfolder/run_state.h"

#include <fmt/format.h>

#include "sgs/core/config.h"
#include "sgs/io/toml_config.h"
#include "sgs/runfolder/folder_lock.h"
#include "sgs/runfolder/run_files.h"

namespace sgs::run {
namespace fs = std::filesystem;
namespace {

void declare_state(RunState& state, ParameterList& list) {
  constexpr double kMostFrames = 1e9;
  const auto group = list.group("run");
  list.add("state", state.stage, "How far the run has come.");
  list.add("owner", state.owner, "Process, machine and time of its start.", {});
  list.add("frames", state.frames, "Frames handled, once it has ended.", "", {0, kMostFrames});
  list.add("reason", state.reason, "Why it was interrupted.", {});
  list.add("live", state.live, "Frames came at the camera's rate, or from a stream: not again.");
  list.add("input", state.input, "While it runs: what a live input suffers from.", {});
  list.add("recording", state.recording, "Folder that frames were kept in, seen from this one.",
           {});
}

}  // namespace

std::string RunState::word() const { return unfinished() && !held ? "killed" : to_string(stage); }

std::string RunState::sentence(const fs::path& folder) const {
  const std::string who = owner.empty() ? "an unknown process" : owner;
  const std::string remedy =
      live ? "" : fmt::format("; `sgs run --resume {}` goes on with it", folder.string());
  switch (stage) {
    case Stage::kFinished:
      return "";
    case Stage::kInterrupted:
      return fmt::format("{} was interrupted after {} frames: {}{}", folder.string(), frames,
                         reason, remedy);
    case Stage::kRunning:
      break;
  }
  const std::string trouble = input.empty() ? "" : fmt::format(" ({})", input);
  return held ? fmt::format("{} is still being written by {}{}: this is what is there so far",
                            folder.string(), who, trouble)
              : fmt::format("{} is unfinished, {} was killed: this is what it had written{}",
                            folder.string(), who, remedy);
}

std::string state_text(const RunState& state) {
  RunState copy = state;  // declaring needs mutable fields
  ParameterList list;
  declare_state(copy, list);
  return "# Written by sgs.\n" + list.to_toml();
}

Result<RunState> load_state(const fs::path& folder) {
  RunState state;
  const fs::path path = folder / files::kState;
  std::error_code unreadable;
  if (!fs::exists(path, unreadable)) return state;
  ParameterList list;
  declare_state(state, list);
  SGS_RETURN_IF_ERROR(io::apply_toml_file(path, list));
  state.held = FolderLock::is_held(folder);
  return state;
}

}  // namespace sgs::run
