// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/slam/pose_correction.h"

#include <algorithm>

namespace sgs::slam {
namespace {

SE3 correction(const KeyframePose& keyframe) {
  return keyframe.T_world_refined * keyframe.T_world_tracked.inverse();
}

}  // namespace

SE3 corrected_pose(const SE3& T_world_tracked, double timestamp_s,
                   const std::vector<KeyframePose>& keyframes) {
  if (keyframes.empty()) return T_world_tracked;
  const auto after =
      std::lower_bound(keyframes.begin(), keyframes.end(), timestamp_s,
                       [](const KeyframePose& k, double time) { return k.timestamp_s < time; });
  if (after == keyframes.begin()) return correction(keyframes.front()) * T_world_tracked;
  if (after == keyframes.end()) return correction(keyframes.back()) * T_world_tracked;
  const KeyframePose& before = *std::prev(after);
  const double alpha =
      (timestamp_s - before.timestamp_s) / (after->timestamp_s - before.timestamp_s);
  // Interpolating the corrected poses instead of the corrections keeps the result independent of
  // where the world's origin lies.
  return interpolate(correction(before) * T_world_tracked, correction(*after) * T_world_tracked,
                     alpha);
}

}  // namespace sgs::slam
