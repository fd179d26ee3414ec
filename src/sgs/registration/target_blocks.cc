// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/registration/target_blocks.h"

namespace sgs::registration {
namespace {

constexpr float kSide_m = 0.5f;
constexpr float kRadius_m = 0.87f * kSide_m;  // of the sphere around a cube: half its diagonal

std::uint64_t key_of(const Eigen::Vector3i& cube) {
  constexpr std::uint64_t kMask = (1u << 21) - 1;
  const auto part = [](int k) { return static_cast<std::uint64_t>(k) & kMask; };
  return part(cube.x()) << 42 | part(cube.y()) << 21 | part(cube.z());
}

}  // namespace

void TargetBlocks::update(const TargetCloud& cloud) {
  if (cloud.layout != layout_ || cloud.moves != moves_ || cloud.points.size() < known_) {
    blocks_.clear();
    block_at_.clear();
    known_ = 0;
    layout_ = cloud.layout;
    moves_ = cloud.moves;
  }
  for (; known_ < cloud.points.size(); ++known_) add(cloud, known_);
}

void TargetBlocks::add(const TargetCloud& cloud, std::size_t index) {
  const Eigen::Vector3f& p = cloud.points[index].point;
  constexpr float kFarthest_m = 1e5f;
  if (!(p.cwiseAbs().maxCoeff() < kFarthest_m)) return;  // not a place, NaN included
  const Eigen::Vector3i cube = (p / kSide_m).array().floor().matrix().cast<int>();
  const auto [at, is_new] = block_at_.try_emplace(key_of(cube), blocks_.size());
  if (is_new) {
    blocks_.push_back({kSide_m * (cube.cast<float>() + Eigen::Vector3f::Constant(0.5f)), {}});
  }
  blocks_[at->second].points.push_back(static_cast<std::uint32_t>(index));
}

// A sphere around each cube against the half spaces that contain the field of view.
std::vector<std::size_t> TargetBlocks::in_view(const PinholeCamera& camera,
                                               const SE3& T_map_camera) const {
  const SE3 T_camera_map = T_map_camera.inverse();
  const Eigen::Matrix3f R = T_camera_map.R.cast<float>();
  const Eigen::Vector3f t = T_camera_map.t.cast<float>();
  const double left = camera.cx + 1, right = camera.width - camera.cx;
  const double top = camera.cy + 1, bottom = camera.height - camera.cy;
  Eigen::Matrix<double, 5, 3> n;
  n << camera.fx, 0, left, -camera.fx, 0, right, 0, camera.fy, top, 0, -camera.fy, bottom, 0, 0, 1;
  const Eigen::Matrix<float, 5, 3> inward = n.rowwise().normalized().cast<float>();

  std::vector<std::size_t> seen;
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    if ((inward * (R * blocks_[b].centre + t)).minCoeff() > -kRadius_m) seen.push_back(b);
  }
  return seen;
}

}  // namespace sgs::registration
