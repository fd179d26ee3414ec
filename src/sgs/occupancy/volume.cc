// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/occupancy/volume.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "sgs/core/error.h"

namespace sgs::occupancy {
namespace {

constexpr int kShift = 4;  // of the edge of a block

Eigen::Vector3i block_of(const Eigen::Vector3i& voxel) {
  return {voxel.x() >> kShift, voxel.y() >> kShift, voxel.z() >> kShift};
}

std::size_t place_in_block(const Eigen::Vector3i& voxel) {
  constexpr int kMask = (1 << kShift) - 1;
  return static_cast<std::size_t>(((voxel.z() & kMask) << 2 * kShift) |
                                  ((voxel.y() & kMask) << kShift) | (voxel.x() & kMask));
}

Eigen::Vector3i floored(const Eigen::Vector3d& p) { return p.array().floor().cast<int>(); }

void count_up(std::uint16_t& counter) {
  if (counter < std::numeric_limits<std::uint16_t>::max()) ++counter;
}

}  // namespace

std::size_t OccupancyVolume::Hash::operator()(const Eigen::Vector3i& key) const {
  // Teschner et al., Optimized Spatial Hashing, 2003.
  return static_cast<std::size_t>(key.x()) * 73856093u ^
         static_cast<std::size_t>(key.y()) * 19349663u ^
         static_cast<std::size_t>(key.z()) * 83492791u;
}

OccupancyVolume::OccupancyVolume(const VolumeConfig& config) : config_(config) {
  SGS_CHECK(config.voxel_m > 0 && config.range_m > 0 && config.min_views > 0,
            "sizes must be positive");
}

OccupancyVolume::Voxel* OccupancyVolume::find(const Eigen::Vector3i& voxel) {
  const Eigen::Vector3i key = block_of(voxel);
  if (last_block_ == nullptr || key != last_key_) {
    auto block = blocks_.find(key);
    if (block == blocks_.end()) {
      block = blocks_.emplace(key, std::make_unique<Block>()).first;
    }
    last_key_ = key;
    last_block_ = block->second.get();
  }
  return &last_block_->voxels[place_in_block(voxel)];
}

/// Every voxel along a segment (Amanatides and Woo, Eurographics 1987); in voxels.
void OccupancyVolume::pass(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Vector3d way = to - from;
  Eigen::Vector3i voxel = floored(from), step;
  Eigen::Vector3d next, every;  // share of the way to the next border, and between two of them
  for (int k = 0; k < 3; ++k) {
    step[k] = way[k] > 0 ? 1 : -1;
    const double border = way[k] > 0 ? voxel[k] + 1 : voxel[k];
    next[k] = way[k] != 0 ? (border - from[k]) / way[k] : std::numeric_limits<double>::infinity();
    every[k] = way[k] != 0 ? std::abs(1 / way[k]) : std::numeric_limits<double>::infinity();
  }
  while (true) {
    Voxel& here = *find(voxel);
    if (here.last_view != view_) {
      here.last_view = view_;
      count_up(here.passes);
    }
    int axis = 0;
    if (next[1] < next[axis]) axis = 1;
    if (next[2] < next[axis]) axis = 2;
    if (!(next[axis] <= 1)) return;
    voxel[axis] += step[axis];
    next[axis] += every[axis];
  }
}

bool OccupancyVolume::add(std::span<const DepthSample> samples, const SE3& T_world_camera) {
  // A ray that nearly runs along a surface goes through voxels that the surface cuts: nothing is
  // said of those nearer to it than this.
  constexpr double kClear_voxels = 1, kLeastCosine = 0.05;
  if (blocks_.size() >= kMaxBlocks) return false;
  ++view_;
  const double per_m = 1 / config_.voxel_m;
  for (const DepthSample& sample : samples) {
    if (sample.point.norm() > config_.range_m) continue;
    Voxel& voxel = *find(floored(per_m * (T_world_camera * sample.point)));
    if (voxel.last_view == view_) continue;
    voxel.last_view = view_;
    count_up(voxel.hits);
  }
  const Eigen::Vector3d from = per_m * T_world_camera.t;
  for (const DepthSample& sample : samples) {
    const double length_m = sample.point.norm();
    const double cosine = -sample.normal.dot(sample.point) / length_m;
    const double clear_m = kClear_voxels * config_.voxel_m / std::max(cosine, kLeastCosine);
    const double free_m = std::min(length_m - clear_m, config_.range_m);
    if (free_m <= 0) continue;
    pass(from, per_m * (T_world_camera * (free_m / length_m * sample.point)));
  }
  return true;
}

Cell OccupancyVolume::cell_of(const Voxel& voxel) const {
  constexpr int kPassesPerHit = 2;  // a surface is missed more easily than invented
  const int hits = voxel.hits, passes = voxel.passes;
  if (hits >= config_.min_views && kPassesPerHit * hits > passes) return Cell::kOccupied;
  return passes >= config_.min_views && passes > hits ? Cell::kFree : Cell::kUnknown;
}

Cell OccupancyVolume::at(const Eigen::Vector3i& voxel) const {
  const auto block = blocks_.find(block_of(voxel));
  if (block == blocks_.end()) return Cell::kUnknown;
  return cell_of(block->second->voxels[place_in_block(voxel)]);
}

void OccupancyVolume::for_each(
    const std::function<void(const Eigen::Vector3i&, Cell)>& visit) const {
  std::vector<Eigen::Vector3i> keys;
  for (const auto& [key, block] : blocks_) keys.push_back(key);
  std::sort(keys.begin(), keys.end(), [](const auto& a, const auto& b) {
    return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
  });
  for (const Eigen::Vector3i& key : keys) {
    const Block& block = *blocks_.at(key);
    for (int z = 0; z < kEdge; ++z) {
      for (int y = 0; y < kEdge; ++y) {
        for (int x = 0; x < kEdge; ++x) {
          const Eigen::Vector3i voxel = kEdge * key + Eigen::Vector3i(x, y, z);
          const Cell cell = cell_of(block.voxels[place_in_block(voxel)]);
          if (cell != Cell::kUnknown) visit(voxel, cell);
        }
      }
    }
  }
}

}  // namespace sgs::occupancy
