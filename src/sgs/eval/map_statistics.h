// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "sgs/core/image.h"
#include "sgs/eval/histogram.h"
#include "sgs/geometry/se3.h"
#include "sgs/map/gaussian.h"

namespace sgs::eval {

/// How the Gaussians of a map are distributed.
struct MapStatistics {
  Histogram opacity;  ///< 0..1
  /// Decimal logarithm of the standard deviations in metres: thinnest, middle, widest axis.
  Histogram thinnest, middle, widest;
};
MapStatistics map_statistics(std::span<const map::Gaussian> gaussians);

/// A Gaussian of the map for an overview, flattened to a disc.
struct MapPoint {
  Eigen::Vector3f position_m;
  Rgb8 color;
  /// The two widest principal axes, the widest first, as long as their standard deviations.
  std::array<Eigen::Vector3f, 2> axes_m = {Eigen::Vector3f::Zero(), Eigen::Vector3f::Zero()};
};
/// At most `count` of the Gaussians more solid than not, evenly out of the map's order and carried
/// by `T_target_world`; axes grow to cover for what is left out.
std::vector<MapPoint> sample_points(std::span<const map::Gaussian> gaussians, std::size_t count,
                                    const SE3& T_target_world);

}  // namespace sgs::eval
