// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/synthetic/random.h"

#include <algorithm>
#include <cmath>

namespace sgs::synthetic {

namespace {

// Inverse of the normal distribution function by Newton's method on erfc; run once.
double normal_quantile(double p) {
  double x = 0;
  for (int i = 0; i < 60; ++i) {
    const double f = 0.5 * std::erfc(-x / std::sqrt(2.0)) - p;
    const double density = std::exp(-0.5 * x * x) / std::sqrt(2 * M_PI);
    x -= std::clamp(f / std::max(density, 1e-300), -0.5, 0.5);
  }
  return x;
}

std::array<float, 4> bspline_weights(float f) {
  const float g = 1 - f;
  return {g * g * g / 6, (4 - 6 * f * f + 3 * f * f * f) / 6, (4 - 6 * g * g + 3 * g * g * g) / 6,
          f * f * f / 6};
}

}  // namespace

GaussTable::GaussTable() {
  // Mean of the slice between two quantiles: difference of the densities over the probability.
  const auto density = [](double x) { return std::exp(-0.5 * x * x) / std::sqrt(2 * M_PI); };
  double previous = 0;
  for (std::size_t i = 0; i < table_.size(); ++i) {
    const bool last = i + 1 == table_.size();
    const double next = last ? 0 : density(normal_quantile((static_cast<double>(i) + 1) / 4096));
    table_[i] = static_cast<float>((previous - next) * 4096);
    previous = next;
  }
}

const GaussTable& GaussTable::instance() {
  static const GaussTable table;
  return table;
}

SmoothField::SmoothField(int width, int height, float cell_px, std::uint64_t seed)
    : width_(width),
      columns_(static_cast<int>(static_cast<float>(width) / cell_px) + 5),
      cell_px_(cell_px) {
  const int rows = static_cast<int>(static_cast<float>(height) / cell_px) + 5;
  lattice_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows));
  const GaussTable& gauss = GaussTable::instance();
  for (std::size_t i = 0; i < lattice_.size(); ++i) lattice_[i] = gauss(hash64(seed, i), 0);
}

void SmoothField::row(int y, float* out) const {
  const float v = static_cast<float>(y) / cell_px_;
  const int j = static_cast<int>(v);
  const auto wy = bspline_weights(v - static_cast<float>(j));
  std::vector<float> line(static_cast<std::size_t>(columns_), 0.f);
  float norm_y = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    const float* source =
        lattice_.data() + (static_cast<std::size_t>(j) + k) * static_cast<std::size_t>(columns_);
    for (std::size_t c = 0; c < line.size(); ++c) line[c] += wy[k] * source[c];
    norm_y += wy[k] * wy[k];
  }
  for (int x = 0; x < width_; ++x) {
    const float u = static_cast<float>(x) / cell_px_;
    const int i = static_cast<int>(u);
    const auto wx = bspline_weights(u - static_cast<float>(i));
    const float* l = line.data() + i;
    const float norm_x = wx[0] * wx[0] + wx[1] * wx[1] + wx[2] * wx[2] + wx[3] * wx[3];
    out[x] =
        (wx[0] * l[0] + wx[1] * l[1] + wx[2] * l[2] + wx[3] * l[3]) / std::sqrt(norm_x * norm_y);
  }
}

void fractal_row(const FractalOptions& options, std::uint64_t seed, int width, int y, float* out) {
  std::fill(out, out + width, 0.f);
  float amplitude = 1, total = 0, cell_x = options.cell_x_px, cell_y = options.cell_y_px;
  std::vector<float> line;
  for (int o = 0; o < options.octaves && std::max(cell_x, cell_y) >= 2; ++o) {
    const float v = static_cast<float>(y) / cell_y;
    const int j = static_cast<int>(std::floor(v));
    float fy = v - static_cast<float>(j);
    fy = fy * fy * (3 - 2 * fy);
    const int columns = static_cast<int>(static_cast<float>(width) / cell_x) + 3;
    line.resize(static_cast<std::size_t>(columns));
    const std::uint64_t key = hash64(seed, static_cast<std::uint64_t>(o));
    for (int c = 0; c < columns; ++c) {
      const auto at = [&](int row) {
        return unit_float(
            hash64(key ^ (static_cast<std::uint64_t>(row) << 32) ^ static_cast<std::uint64_t>(c)));
      };
      line[static_cast<std::size_t>(c)] = amplitude * (2 * ((1 - fy) * at(j) + fy * at(j + 1)) - 1);
    }
    for (int x = 0; x < width; ++x) {
      const float u = static_cast<float>(x) / cell_x;
      const int i = static_cast<int>(u);
      float fx = u - static_cast<float>(i);
      fx = fx * fx * (3 - 2 * fx);
      const float a = line[static_cast<std::size_t>(i)], b = line[static_cast<std::size_t>(i) + 1];
      out[x] += a + fx * (b - a);
    }
    total += amplitude * amplitude;
    amplitude *= options.gain;
    cell_x *= 0.5f;
    cell_y *= 0.5f;
  }
  const float scale = total > 0 ? 1.4f / std::sqrt(total) : 0.f;
  for (int x = 0; x < width; ++x) out[x] *= scale;
}

std::vector<float> fractal_field(const FractalOptions& options, std::uint64_t seed, int width,
                                 int height) {
  std::vector<float> field(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (int y = 0; y < height; ++y)
    fractal_row(options, seed, width, y,
                field.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width));
  return field;
}

}  // namespace sgs::synthetic
