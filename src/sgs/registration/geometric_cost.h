// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "sgs/registration/cell_mask.h"
#include "sgs/registration/correspondence_search.h"
#include "sgs/registration/linearization.h"

namespace sgs::registration {

/// The geometric part of a frame's normal equations: correspondences and the chosen factor, summed
/// in chunks of a fixed size. `T` is always the camera's pose in the search's reference frame.
/// Deterministic; keeps the last matches, hence not thread-safe.
class GeometricCost {
 public:
  explicit GeometricCost(const FactorConfig& config);

  /// Searches anew at `T` and linearises there, without the points in `moving`.
  Linearization linearize(const SourceCloud& source, const CorrespondenceSearch& search,
                          const SE3& T_reference_camera, const CellMask& moving = {});
  /// Linearises at `T` with the matches of the last linearize() of the same cloud and search: the
  /// search is the dear part, and near the optimum it finds the same pairs again.
  Linearization relinearize(const SourceCloud& source, const CorrespondenceSearch& search,
                            const SE3& T_reference_camera) const;
  /// Cost at `T` with the matches of the last linearize(), for trial steps.
  double error(const SourceCloud& source, const CorrespondenceSearch& search,
               const SE3& T_reference_camera) const;
  /// Share of the source points whose match lies within `distance_m` at `T`.
  double overlap(const SourceCloud& source, const CorrespondenceSearch& search,
                 const SE3& T_reference_camera, double distance_m) const;
  /// Matches of the last linearize().
  const std::vector<int>& matches() const { return matches_; }

 private:
  FactorConfig config_;
  bool gicp_;
  std::vector<int> matches_;
};

}  // namespace sgs::registration
