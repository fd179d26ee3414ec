// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/slam/video_gap.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sgs::slam {
namespace {

constexpr double kVideo_fps = 30;
constexpr double kStep_m = 0.01, kStep_rad = std::numbers::pi / 180;
constexpr double kJump_m = 0.15, kJump_rad = 0.17;

}  // namespace

double video_frames_between(const StampedPose& earlier, const StampedPose& later, double limit) {
  // Times of a 30 Hz camera jitter: their frames are to count as one.
  double frames = std::round(kVideo_fps * (later.timestamp_s - earlier.timestamp_s));
  const SE3 step = earlier.T_world_camera.inverse() * later.T_world_camera;
  const double moved_m = step.t.norm(), turned_rad = step.angle();
  if (moved_m > kJump_m || turned_rad > kJump_rad) {
    frames = std::max({frames, moved_m / kStep_m, turned_rad / kStep_rad});
  }
  // Written so that NaN is 1.
  return frames > 1 ? std::min(frames, limit) : 1;
}

}  // namespace sgs::slam
