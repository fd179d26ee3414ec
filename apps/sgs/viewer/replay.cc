// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "viewer/replay.h"

#include <fmt/format.h>

#include "sgs/runfolder/version.h"

namespace sgs::app {
namespace {

/// The ground truth moved so that its first pose is the estimate's.
void add_truth(const Trajectory& truth, std::vector<viewer::FrameUpdate>& updates) {
  constexpr double kMaxGap_s = 0.1;
  std::optional<SE3> T_world_truth;
  for (viewer::FrameUpdate& update : updates) {
    const auto pose = truth.at(update.record.timestamp_s, kMaxGap_s);
    if (!pose) continue;
    if (!T_world_truth) T_world_truth = update.T_world_camera * pose->inverse();
    update.truth = *T_world_truth * *pose;
  }
}

}  // namespace

Result<Replay> load_replay(const std::filesystem::path& folder, std::uint64_t map_version) {
  SGS_ASSIGN_OR_RETURN(auto run,
                       run::load_run(folder, run::kCamera | run::kTrajectory | run::kKeyframes |
                                                 run::kTruth | run::kFrames | run::kMap));
  Replay replay;
  replay.input = run.input;
  replay.metrics = run.metrics;
  replay.unfinished = run.state.unfinished();
  replay.info.version = run::version();
  replay.info.input = run.name;
  replay.info.tracker = to_string(run.config.tracker.type);
  replay.info.preset = to_string(run.config.preset);
  replay.info.live = false;
  replay.info.camera = run.camera;
  if (run.upright) replay.info.up = run.upright->up;
  replay.info.frames_total = static_cast<std::int64_t>(run.frames.size());
  const Trajectory views = run::view_poses(run);
  const auto map =
      run::as_snapshot({std::move(run.gaussians), std::move(run.harmonics)}, map_version);
  for (slam::FrameRecord& record : run.frames) {
    const auto pose = views.at(record.timestamp_s, 0);
    if (record.bad || !pose) continue;
    viewer::FrameUpdate update;
    update.record = std::move(record);
    update.T_world_camera = *pose;
    update.map = map;
    replay.updates.push_back(std::move(update));
  }
  if (replay.updates.empty()) {
    return fail(
        ErrorCode::kInvalidFormat,
        fmt::format("{}: no frame of frames.csv has a pose in trajectory.txt", folder.string()),
        run.state.unfinished() ? "the run was killed, or has only just begun"
                               : "is it the folder of a run?");
  }
  add_truth(run.truth, replay.updates);
  return replay;
}

}  // namespace sgs::app
