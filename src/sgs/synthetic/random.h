// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

namespace sgs::synthetic {

/// Well-mixed 64-bit hash of a counter (the finaliser of SplitMix64; Steele, Lea, Flood, OOPSLA
/// 2014). All randomness here is a hash of what it belongs to, so that nothing depends on the order
/// in which threads ask for it.
inline std::uint64_t hash64(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ull;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}
inline std::uint64_t hash64(std::uint64_t a, std::uint64_t b) { return hash64(hash64(a) ^ b); }
/// FNV-1a, to give names a place in the counter space.
inline std::uint64_t hash_name(std::string_view name) {
  std::uint64_t h = 0xcbf29ce484222325ull;
  for (char c : name) h = (h ^ static_cast<unsigned char>(c)) * 0x100000001b3ull;
  return h;
}
/// Uniform in [0, 1).
inline float unit_float(std::uint64_t h) { return static_cast<float>(h >> 40) * 0x1p-24f; }

/// A stream of random numbers for building things, where speed does not matter.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(hash64(seed)) {}
  std::uint64_t bits() { return hash64(state_++); }
  float uniform(float lo = 0, float hi = 1) { return lo + (hi - lo) * unit_float(bits()); }
  /// Uniform in [lo, hi], both included.
  int integer(int lo, int hi) {
    return lo + static_cast<int>(bits() % static_cast<std::uint64_t>(hi - lo + 1));
  }
  bool chance(float p) { return uniform() < p; }

 private:
  std::uint64_t state_;
};

/// Four standard normal numbers per hash, from 12 bits each: the means of 4096 slices of equal
/// probability, so mean and variance are exact up to rounding and nothing lies beyond 3.7 sigma.
class GaussTable {
 public:
  static const GaussTable& instance();
  float operator()(std::uint64_t h, int which) const { return table_[(h >> (16 * which)) & 4095u]; }

 private:
  GaussTable();
  std::array<float, 4096> table_;
};

/// Smooth random field of zero mean and unit variance: normal numbers on a lattice of `cell_px`,
/// blended by cubic B-splines.
class SmoothField {
 public:
  SmoothField(int width, int height, float cell_px, std::uint64_t seed);
  /// Values of one image row; `out` has `width` entries.
  void row(int y, float* out) const;

 private:
  int width_, columns_;
  float cell_px_;
  std::vector<float> lattice_;
};

/// Fractal value noise in about [-1, 1]: octaves of smoothly blended lattice noise, halving the
/// cell from `cell_px` downwards until it reaches two pixels, amplitudes shrinking by `gain`.
struct FractalOptions {
  float cell_x_px = 64, cell_y_px = 64;
  int octaves = 6;
  float gain = 0.55f;
};
/// Row `y` of such noise; `out` has `width` entries. Thread-safe.
void fractal_row(const FractalOptions& options, std::uint64_t seed, int width, int y, float* out);
/// The same noise on a whole image, row by row.
std::vector<float> fractal_field(const FractalOptions& options, std::uint64_t seed, int width,
                                 int height);

}  // namespace sgs::synthetic
