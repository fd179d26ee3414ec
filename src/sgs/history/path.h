// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "sgs/geometry/pose_correction.h"
#include "sgs/geometry/se3.h"

namespace sgs::history {

/// Where the camera was when each frame came, as known now: the one place that keeps it. Who
/// remembers a frame keeps its index and asks. A value: copies share their entries, cost next to
/// nothing and stay as they are, whatever happens to others; they may be read and continued from
/// any threads.
class Path {
 public:
  struct Entry {
    std::int64_t frame = 0;  ///< index of the frame
    double timestamp_s = 0;
    SE3 T_odom_camera;  ///< of a lost frame what the tracker took it for
  };

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  const Entry& operator[](std::size_t k) const {
    return (*blocks_)[k / kBlock]->entries[k % kBlock];
  }
  const Entry& back() const { return (*this)[size_ - 1]; }

  /// Null where the path has no such frame.
  const Entry* find(std::int64_t frame) const;
  bool contains(std::int64_t frame) const { return find(frame) != nullptr; }
  /// The pose of a frame, which must be in the path.
  const SE3& at(std::int64_t frame) const;

  /// Goes on by a frame, which must come after the last one. Copies do not see it.
  void append(const Entry& entry);
  /// The path with all of its poses moved.
  Path moved(const PoseCorrection& correction) const;

 private:
  static constexpr std::size_t kBlock = 256;
  /// Entries that were written once are never written again. Who continues a path takes the next
  /// one of its block, or a copy of the block where another copy of the path has taken it.
  struct Block {
    std::array<Entry, kBlock> entries;
    std::atomic<std::size_t> used = 0;
  };
  using Blocks = std::vector<std::shared_ptr<Block>>;

  std::shared_ptr<const Blocks> blocks_;
  std::size_t size_ = 0;
};

}  // namespace sgs::history
