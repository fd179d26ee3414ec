// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/io/spz_attributes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "sgs/core/error.h"
#include "sgs/io/splat_check.h"

namespace sgs::io {
namespace {

constexpr int kMaxFractionalBits = 16;
constexpr double kLargestFixed = (1 << 23) - 1;
/// The same turn for the harmonics, basis function by basis function: odd in y or z, but not in
/// both.
constexpr std::array<double, map::Harmonics::basis_functions(map::kMaxHarmonicDegree)>
    kHarmonicSigns = {-1, -1, 1, -1, 1, 1, -1, 1, -1, 1, -1, -1, 1, -1, 1};
constexpr double kHarmonicScale = 128;
constexpr double kColorScale = 0.15;  // of the SH coefficient, so that out-of-range colours fit
/// Right-down-forward to right-up-back: signs of the axes, and of the quaternion's vector part.
constexpr std::array<double, 3> kSigns = {1, -1, -1};
/// Of a component that is not the largest: its magnitude at most, and the steps up to there.
constexpr double kLargestOfSmall = 1 / std::numbers::sqrt2, kSteps = 511;

char byte_char(double value) {
  return static_cast<char>(static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0))));
}
double value_of(char c) { return static_cast<double>(static_cast<std::uint8_t>(c)); }
std::uint32_t bits_of(char c) { return static_cast<std::uint8_t>(c); }

void append_position(std::string& out, const map::Gaussian& g, int bits) {
  for (std::size_t k = 0; k < 3; ++k) {
    const auto fixed =
        static_cast<std::int32_t>(std::lround(std::ldexp(kSigns[k] * g.mean[k], bits)));
    for (int shift = 0; shift < 24; shift += 8) out += static_cast<char>(fixed >> shift & 0xFF);
  }
}

double position_of(const char* at, int bits) {
  std::uint32_t fixed = 0;
  for (int i = 0; i < 3; ++i) fixed |= bits_of(at[i]) << (8 * i);
  if (fixed & 0x800000) fixed |= 0xFF000000;
  return std::ldexp(static_cast<double>(static_cast<std::int32_t>(fixed)), -bits);
}

/// A half turn about one of its own axes leaves an ellipsoid as it is. Of the four rotations that
/// differ by them, the one with the largest w: w is not stored, and computing it from 8-bit x y z
/// is precise only when it is large.
std::array<double, 4> largest_w(const std::array<double, 4>& q) {
  const std::array<std::array<double, 4>, 4> equal = {
      q, {{-q[1], q[0], q[3], -q[2]}}, {{-q[2], -q[3], q[0], q[1]}}, {{-q[3], q[2], -q[1], q[0]}}};
  return *std::max_element(equal.begin(), equal.end(), [](const auto& a, const auto& b) {
    return std::abs(a[0]) < std::abs(b[0]);
  });
}

void append_first_three(std::string& out, const map::Gaussian& g) {
  const auto q = largest_w(unit_rotation(g));
  const double sign = q[0] < 0 ? -1 : 1;
  for (std::size_t k = 0; k < 3; ++k) out += byte_char(127.5 + 127.5 * sign * kSigns[k] * q[k + 1]);
}

void set_first_three(map::Gaussian& g, const char* at) {
  double squares = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double q = value_of(at[k]) / 127.5 - 1;
    g.rotation[k + 1] = static_cast<float>(kSigns[k] * q);
    squares += q * q;
  }
  g.rotation[0] = static_cast<float>(std::sqrt(std::max(0.0, 1 - squares)));
}

/// x y z w in 32 bits, from the top: which component is the largest (2), and of each of the others
/// whether it is negative (1) and its magnitude (9). Signs are those that make the largest
/// positive.
void append_smallest_three(std::string& out, const map::Gaussian& g) {
  const auto wxyz = unit_rotation(g);
  const std::array<double, 4> q = {kSigns[0] * wxyz[1], kSigns[1] * wxyz[2], kSigns[2] * wxyz[3],
                                   wxyz[0]};
  const auto largest = static_cast<std::size_t>(
      std::max_element(q.begin(), q.end(),
                       [](double a, double b) { return std::abs(a) < std::abs(b); }) -
      q.begin());
  auto packed = static_cast<std::uint32_t>(largest);
  for (std::size_t k = 0; k < 4; ++k) {
    if (k == largest) continue;
    const std::uint32_t negative = (q[k] < 0) != (q[largest] < 0) ? 1 : 0;
    const double steps = std::min(kSteps, kSteps * std::abs(q[k]) / kLargestOfSmall);
    packed = packed << 10 | negative << 9 | static_cast<std::uint32_t>(std::lround(steps));
  }
  for (int shift = 0; shift < 32; shift += 8) out += static_cast<char>(packed >> shift & 0xFF);
}

void set_smallest_three(map::Gaussian& g, const char* at) {
  std::uint32_t packed = 0;
  for (int i = 0; i < 4; ++i) packed |= bits_of(at[i]) << (8 * i);
  const std::size_t largest = packed >> 30;
  std::array<double, 4> q{};
  double squares = 0;
  for (std::size_t k = 4; k-- > 0;) {
    if (k == largest) continue;
    const double magnitude = kLargestOfSmall * (packed & 0x1FF) / kSteps;
    q[k] = packed & 0x200 ? -magnitude : magnitude;
    squares += magnitude * magnitude;
    packed >>= 10;
  }
  q[largest] = std::sqrt(std::max(0.0, 1 - squares));
  g.rotation[0] = static_cast<float>(q[3]);
  for (std::size_t k = 0; k < 3; ++k) g.rotation[k + 1] = static_cast<float>(kSigns[k] * q[k]);
}

}  // namespace

std::array<std::size_t, SpzLayout::kAttributes> SpzLayout::bytes() const {
  const std::size_t harmonic = 3 * map::Harmonics::basis_functions(harmonic_degree);
  return {9 * count,       count, 3 * count, 3 * count, (smallest_three ? 4 : 3) * count,
          harmonic * count};
}

std::optional<int> spz_fractional_bits(std::span<const map::Gaussian> splats) {
  double largest = 0;
  for (const map::Gaussian& g : splats) {
    for (const float v : g.mean) largest = std::max(largest, std::abs(static_cast<double>(v)));
  }
  int bits = kMaxFractionalBits;
  while (bits >= 0 && std::ldexp(largest, bits) > kLargestFixed) --bits;
  if (bits < 0) return std::nullopt;
  return bits;
}

std::array<std::string, SpzLayout::kAttributes> spz_attributes(
    std::span<const map::Gaussian> splats, const map::Harmonics& harmonics,
    const SpzLayout& layout) {
  std::array<std::string, SpzLayout::kAttributes> out;
  const auto bytes = layout.bytes();
  for (std::size_t i = 0; i < out.size(); ++i) out[i].reserve(bytes[i]);
  for (const map::Gaussian& g : splats) {
    append_position(out[SpzLayout::kPositions], g, layout.fractional_bits);
    out[SpzLayout::kOpacities] += byte_char(255 * map::opacity<double>(g));
    for (const float c : g.rgb) {
      out[SpzLayout::kColors] += byte_char(255 * (0.5 + kColorScale * (c - 0.5) / kSh0));
    }
    for (const float s : g.log_scale) out[SpzLayout::kScales] += byte_char(16 * (s + 10.0));
    if (layout.smallest_three) {
      append_smallest_three(out[SpzLayout::kRotations], g);
    } else {
      append_first_three(out[SpzLayout::kRotations], g);
    }
  }
  for (std::size_t i = 0; i < harmonics.coefficients.size(); ++i) {
    const std::size_t function = i % harmonics.floats() / 3;
    out[SpzLayout::kHarmonics] += byte_char(
        kHarmonicScale * (1 + kHarmonicSigns[function] * double{harmonics.coefficients[i]}));
  }
  return out;
}

map::SplatMap splats_from_spz(
    const std::array<std::string_view, SpzLayout::kAttributes>& attributes,
    const SpzLayout& layout) {
  const auto bytes = layout.bytes();
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    SGS_CHECK(attributes[i].size() == bytes[i], "attributes of another layout");
  }
  map::SplatMap splats{{}, {layout.harmonic_degree, {}}};
  splats.gaussians.resize(layout.count);
  for (std::size_t i = 0; i < layout.count; ++i) {
    map::Gaussian& g = splats.gaussians[i];
    for (std::size_t k = 0; k < 3; ++k) {
      g.mean[k] = static_cast<float>(
          kSigns[k] * position_of(attributes[SpzLayout::kPositions].data() + 9 * i + 3 * k,
                                  layout.fractional_bits));
      const double color = value_of(attributes[SpzLayout::kColors][3 * i + k]) / 255 - 0.5;
      g.rgb[k] = static_cast<float>(0.5 + kSh0 * color / kColorScale);
      g.log_scale[k] =
          static_cast<float>(value_of(attributes[SpzLayout::kScales][3 * i + k]) / 16 - 10);
    }
    g.opacity_logit = opacity_logit(value_of(attributes[SpzLayout::kOpacities][i]) / 255);
    const char* rotations = attributes[SpzLayout::kRotations].data();
    if (layout.smallest_three) {
      set_smallest_three(g, rotations + 4 * i);
    } else {
      set_first_three(g, rotations + 3 * i);
    }
  }
  splats.harmonics.resize(layout.count);
  const std::size_t floats = splats.harmonics.floats();
  for (std::size_t i = 0; i < floats * layout.count; ++i) {
    const double stored = value_of(attributes[SpzLayout::kHarmonics][i]) / kHarmonicScale - 1;
    splats.harmonics.coefficients[i] = static_cast<float>(kHarmonicSigns[i % floats / 3] * stored);
  }
  return splats;
}

}  // namespace sgs::io
