// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <unordered_map>

#include "sgs/geometry/se3.h"
#include "sgs/occupancy/depth_samples.h"

namespace sgs::occupancy {

/// What is known of a place.
enum class Cell : std::uint8_t { kUnknown, kFree, kOccupied };

struct VolumeConfig {
  double voxel_m = 0.05;
  double range_m = 4;  ///< what is farther away is no surface: only the way to there is free
  int min_views = 2;   ///< a surface, or free space, that fewer views saw is unknown
};

/// Space in voxels: which were seen through, and which hold a surface. Every view counts once per
/// voxel, as a surface if any of its points lies there, else as free if a ray passes. Voxel (i, j,
/// k) is [i, i + 1) x [j, j + 1) x [k, k + 1) times its size. Not thread-safe.
class OccupancyVolume {
 public:
  explicit OccupancyVolume(const VolumeConfig& config);

  /// Adds what a camera saw. False once there are too many voxels for memory: the view is left out.
  bool add(std::span<const DepthSample> samples, const SE3& T_world_camera);

  Cell at(const Eigen::Vector3i& voxel) const;
  double voxel_m() const { return config_.voxel_m; }
  double range_m() const { return config_.range_m; }
  /// Calls `visit(voxel, cell)` for each voxel that is not unknown, in an order that depends on
  /// nothing but what is in the volume.
  void for_each(const std::function<void(const Eigen::Vector3i&, Cell)>& visit) const;

 private:
  static constexpr int kEdge = 16;
  // limit: blocks of 16 x 16 x 16 voxels of `sgs export grid`, `octomap` and `esdf` (2 GB)
  static constexpr std::size_t kMaxBlocks = std::size_t{1} << 16;

  struct Voxel {
    std::uint16_t hits = 0, passes = 0;  ///< views
    std::uint32_t last_view = 0;         ///< that counted here; from 1
  };
  struct Block {
    Voxel voxels[kEdge * kEdge * kEdge];
  };
  struct Hash {
    std::size_t operator()(const Eigen::Vector3i& key) const;
  };

  Voxel* find(const Eigen::Vector3i& voxel);
  void pass(const Eigen::Vector3d& from, const Eigen::Vector3d& to);
  Cell cell_of(const Voxel& voxel) const;

  VolumeConfig config_;
  std::unordered_map<Eigen::Vector3i, std::unique_ptr<Block>, Hash> blocks_;
  Eigen::Vector3i last_key_ = Eigen::Vector3i::Zero();
  Block* last_block_ = nullptr;  ///< the one of that key: neighbours come one after the other
  std::uint32_t view_ = 0;
};

}  // namespace sgs::occupancy
