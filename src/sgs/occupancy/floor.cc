// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/occupancy/floor.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sgs::occupancy {
namespace {

constexpr double kSlice_m = 0.01;

}  // namespace

void FloorFinder::add(std::span<const DepthSample> samples, const SE3& T_upright_camera,
                      double range_m) {
  const double kLevel = std::cos(12 * std::numbers::pi / 180);
  for (const DepthSample& sample : samples) {
    if (sample.area_m2 <= 0 || sample.point.norm() > range_m) continue;
    if ((T_upright_camera.R * sample.normal).z() < kLevel) continue;
    const double z = (T_upright_camera * sample.point).z();
    Slice& slice = slices_[static_cast<int>(std::floor(z / kSlice_m))];
    slice.area_m2 += sample.area_m2;
    slice.moment += sample.area_m2 * z;
  }
}

std::optional<double> FloorFinder::height_m() const {
  constexpr int kBand = 3;             // slices to either side that noise spreads a floor over
  constexpr double kGoodPart = 0.15;   // of all that is level
  constexpr double kLeastArea_m2 = 1;  // summed over views
  const auto band = [&](int middle) {
    Slice sum;
    const auto end = slices_.upper_bound(middle + kBand);
    for (auto slice = slices_.lower_bound(middle - kBand); slice != end; ++slice) {
      sum.area_m2 += slice->second.area_m2;
      sum.moment += slice->second.moment;
    }
    return sum;
  };
  double whole = 0;
  for (const auto& [middle, slice] : slices_) whole += slice.area_m2;
  if (whole < kLeastArea_m2) return std::nullopt;
  for (const auto& [lowest, slice] : slices_) {
    if (band(lowest).area_m2 < kGoodPart * whole) continue;
    // The densest band near where it begins.
    Slice best;
    for (int middle = lowest; middle <= lowest + 2 * kBand; ++middle) {
      const Slice sum = band(middle);
      if (sum.area_m2 > best.area_m2) best = sum;
    }
    return best.moment / best.area_m2;
  }
  return std::nullopt;
}

}  // namespace sgs::occupancy
