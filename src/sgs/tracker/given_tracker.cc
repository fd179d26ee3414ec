// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/tracker/given_tracker.h"

#include <algorithm>
#include <numbers>
#include <vector>

namespace sgs::tracker {
namespace {

/// Of a sample of the measured depths, metres; 1 where nothing was measured.
double typical_depth(const DepthImage& depth) {
  constexpr int kStep_px = 16;
  std::vector<float> values;
  for (int y = 0; y < depth.height(); y += kStep_px) {
    for (int x = 0; x < depth.width(); x += kStep_px) {
      if (depth(x, y) > 0) values.push_back(depth(x, y));
    }
  }
  if (values.empty()) return 1;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

bool GivenTracker::is_new_view(const RgbdFrame& frame, const SE3& T_world_camera) const {
  if (!T_world_keyframe_) return true;
  const SE3 step = T_world_keyframe_->inverse() * T_world_camera;
  return step.angle() > config_.keyframe_rotation_deg * std::numbers::pi / 180 ||
         step.t.norm() > config_.keyframe_translation * typical_depth(frame.depth);
}

TrackResult GivenTracker::track(const RgbdFrame& frame, const history::Revision&,
                                const map::SnapshotPtr&) {
  TrackResult result;
  const auto& given = frame.given_T_world_camera;
  if (!given || !given->all_finite()) {
    result.status = TrackingStatus::kLost;
    result.lost_reason = given ? alignment::LostReason::kNotFinite : alignment::LostReason::kNoPose;
    result.T_odom_camera = T_world_last_;
    return result;
  }
  result.T_odom_camera = T_world_last_ = *given;
  result.keyframe = is_new_view(frame, *given);
  if (result.keyframe) T_world_keyframe_ = *given;
  return result;
}

}  // namespace sgs::tracker
