// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/registration/target_blocks.h"

#include <algorithm>
#include <limits>

namespace sgs::registration {

// Removed ones count where they had been: they may come back.
TargetBlocks::Sphere TargetBlocks::around(const TargetCloud& cloud, std::size_t begin,
                                          std::size_t end) const {
  constexpr float kFar = std::numeric_limits<float>::max();
  Eigen::Array3f low = Eigen::Array3f::Constant(kFar), high = -low;
  for (std::size_t i = begin; i < end; ++i) {
    const auto& p = cloud.points[i].point.array();
    if (!p.isFinite().all()) continue;
    low = low.min(p);
    high = high.max(p);
  }
  if (low.x() > high.x()) return {Eigen::Vector3f::Zero(), -1};
  return {((low + high) / 2).matrix(), ((high - low) / 2).matrix().norm()};
}

void TargetBlocks::follow(const TargetCloud& cloud) {
  if (cloud.layout != layout_ || cloud.moves != moves_ || cloud.points.size() < points_) {
    spheres_.clear();
    points_ = 0;
  }
  layout_ = cloud.layout;
  moves_ = cloud.moves;
  const std::size_t count = cloud.points.size();
  if (count == points_) return;
  spheres_.resize(points_ / kBlock);
  for (std::size_t begin = spheres_.size() * kBlock; begin < count; begin += kBlock) {
    spheres_.push_back(around(cloud, begin, std::min(begin + kBlock, count)));
  }
  points_ = count;
}

const std::vector<TargetBlocks::Range>& TargetBlocks::in_view(
    const ViewPyramid& view, const SE3& T_local_camera,
    const std::function<bool(const Sphere&)>& hidden) {
  const SE3 inverse = T_local_camera.inverse();
  const Eigen::Matrix3f R = inverse.R.cast<float>();
  const Eigen::Vector3f t = inverse.t.cast<float>();
  in_view_.clear();
  for (std::size_t block = 0; block < spheres_.size(); ++block) {
    const Sphere seen{R * spheres_[block].centre + t, spheres_[block].radius};
    if (seen.radius < 0 || !view.may_meet(seen.centre, seen.radius)) continue;
    if (hidden && hidden(seen)) continue;
    const std::size_t begin = block * kBlock, end = std::min(begin + kBlock, points_);
    if (!in_view_.empty() && in_view_.back().end == begin) {
      in_view_.back().end = end;
    } else {
      in_view_.push_back({begin, end});
    }
  }
  return in_view_;
}

}  // namespace sgs::registration
