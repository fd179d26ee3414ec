// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace sgs::map {

inline constexpr int kMaxHarmonicDegree = 3;
/// What formats that spend a byte on a coefficient (SPZ, pages) can hold.
inline constexpr float kLargestHarmonic = 1;

/// How the colours of a map's Gaussians depend on where they are seen from: real spherical
/// harmonics above degree 0, in the order and with the signs of 3D Gaussian Splatting (Kerbl et al.
/// 2023). To map::Gaussian::rgb is added the sum of coefficient times basis function of the unit
/// direction from the camera to the mean. A map made while tracking has none.
struct Harmonics {
  int degree = 0;  ///< 0 = none, up to kMaxHarmonicDegree
  /// floats() numbers per Gaussian: basis function by basis function, red green blue each.
  std::vector<float> coefficients;

  static constexpr std::size_t basis_functions(int degree) {
    return static_cast<std::size_t>((degree + 1) * (degree + 1) - 1);
  }
  /// Numbers per Gaussian.
  std::size_t floats() const { return 3 * basis_functions(degree); }
  bool empty() const { return degree == 0; }
  /// Number of Gaussians that they are for; 0 where there are none.
  std::size_t size() const { return empty() ? 0 : coefficients.size() / floats(); }
  std::span<const float> of(std::size_t gaussian) const {
    return std::span(coefficients).subspan(gaussian * floats(), floats());
  }
  std::span<float> of(std::size_t gaussian) {
    return std::span(coefficients).subspan(gaussian * floats(), floats());
  }
  /// Makes room for `count` Gaussians; new ones look the same from everywhere.
  void resize(std::size_t count) { coefficients.resize(count * floats(), 0.0f); }
};

}  // namespace sgs::map
