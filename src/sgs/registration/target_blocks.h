// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "sgs/camera/pinhole.h"
#include "sgs/geometry/se3.h"
#include "sgs/registration/clouds.h"

namespace sgs::registration {

/// The targets sorted into cubes of space, so that what a camera cannot see is skipped a cube at a
/// time: the cost of a frame follows what is in view and not the length of the session.
class TargetBlocks {
 public:
  /// Brings the cubes in line with `cloud`: new points are added, everything is sorted anew when
  /// its layout changed or points moved.
  void update(const TargetCloud& cloud);

  /// Calls `body(index)` for every point of the cubes that the camera at `T_map_camera` may see, in
  /// an order that depends on the history of the cloud only.
  template <class Body>
  void for_each_in_view(const PinholeCamera& camera, const SE3& T_map_camera,
                        const Body& body) const {
    for (const std::size_t b : in_view(camera, T_map_camera)) {
      for (const std::uint32_t i : blocks_[b].points) body(static_cast<std::size_t>(i));
    }
  }
  std::size_t blocks() const { return blocks_.size(); }

 private:
  struct Block {
    Eigen::Vector3f centre;
    std::vector<std::uint32_t> points;
  };

  std::vector<std::size_t> in_view(const PinholeCamera& camera, const SE3& T_map_camera) const;
  void add(const TargetCloud& cloud, std::size_t index);

  std::vector<Block> blocks_;
  std::unordered_map<std::uint64_t, std::size_t> block_at_;
  std::uint64_t layout_ = 0, moves_ = 0;
  std::size_t known_ = 0;
};

}  // namespace sgs::registration
