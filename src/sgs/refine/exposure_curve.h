// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

namespace sgs::refine {

/// A frame's gains over the map's colour, one per channel.
struct Exposure {
  double timestamp_s = 0;
  std::array<float, 3> gain = {1, 1, 1};
};

/// How bright the camera showed the map in the course of time, as the frames that were learnt from
/// tell: what lies between two of them is known, too, without a look at its picture.
class ExposureCurve {
 public:
  ExposureCurve() = default;
  /// `exposures` in rising time order.
  explicit ExposureCurve(std::vector<Exposure> exposures) : exposures_(std::move(exposures)) {}
  bool empty() const { return exposures_.empty(); }
  /// Interpolated; that of the first or last one beyond them, 1 where none is known.
  std::array<float, 3> at(double timestamp_s) const;

 private:
  std::vector<Exposure> exposures_;
};

}  // namespace sgs::refine
