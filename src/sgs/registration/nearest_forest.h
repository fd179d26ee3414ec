// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

#include "sgs/registration/clouds.h"

namespace sgs::registration {

/// Nearest target in a growing cloud: a forest of kd-trees whose sizes at least double from one to
/// the next (Bentley and Saxe's logarithmic method, 1980). A new keyframe becomes a small tree and
/// is merged with its neighbours only when sizes demand it, so that a point is re-indexed
/// O(log n) times in all and never because a keyframe arrived. Removed and moved targets leave dead
/// entries behind that go at the next merge.
class NearestForest {
 public:
  NearestForest();
  ~NearestForest();
  NearestForest(NearestForest&&) noexcept;
  NearestForest& operator=(NearestForest&&) noexcept;

  /// Brings the index in line with `cloud`: everything anew when its layout changed, else only
  /// points that were added, removed or moved by more than `tolerance_m`.
  void update(const TargetCloud& cloud, float tolerance_m = 0.002f);
  /// Index of the nearest living target within `max_distance_m`, or -1; of equally near ones any,
  /// but always the same.
  int nearest(const Eigen::Vector3f& query, float max_distance_m) const;
  /// Number of trees, for tests.
  std::size_t trees() const;
  /// Entries that were put into a tree so far, rebuilds included; measures the cost of updates.
  std::size_t entries_indexed() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sgs::registration
