// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <span>

#include "sgs/geometry/se3.h"
#include "sgs/occupancy/depth_samples.h"

namespace sgs::occupancy {

/// Finds the height of the floor: the lowest level surface that makes up a good part of all level
/// surfaces seen from above. Not thread-safe.
class FloorFinder {
 public:
  /// Adds what a camera saw; z of the world points up. Only what is within `range_m` counts.
  void add(std::span<const DepthSample> samples, const SE3& T_upright_camera, double range_m);

  /// z of the floor, metres; empty where no level surface was seen.
  std::optional<double> height_m() const;

 private:
  /// Area and its mean height in slices of a centimetre.
  struct Slice {
    double area_m2 = 0, moment = 0;
  };
  std::map<int, Slice> slices_;
};

}  // namespace sgs::occupancy
