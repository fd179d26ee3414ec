// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapper/optimizer.h"

#include <algorithm>
#include <cmath>

namespace sgs::mapper {
namespace {

constexpr std::size_t kFields = sizeof(map::Gaussian) / sizeof(float);

/// A row as the sixteen floats it is made of.
float* floats(map::Gaussian& row) { return reinterpret_cast<float*>(&row); }
const float* floats(const map::Gaussian& row) { return reinterpret_cast<const float*>(&row); }

}  // namespace

Optimizer::Optimizer(const OptimizerConfig& config) : config_(config) {
  const auto fill = [this](std::size_t from, std::size_t count, double rate) {
    std::fill_n(rates_ + from, count, static_cast<float>(rate));
  };
  fill(0, 3, config.rate_mean_m);
  fill(3, 3, config.rate_log_scale);
  fill(6, 4, config.rate_rotation);
  fill(10, 1, config.rate_opacity);
  fill(11, 3, config.rate_color);
  fill(14, 2, 0);
  // Beyond the table both corrections are 1 to float precision for the usual betas.
  constexpr int kTable = 8192;
  for (int t = 1; t <= kTable; ++t) {
    correction1_.push_back(static_cast<float>(1 / (1 - std::pow(config.beta1, t))));
    correction2_.push_back(static_cast<float>(1 / std::sqrt(1 - std::pow(config.beta2, t))));
  }
}

void Optimizer::cap(map::GaussianStore& store, std::size_t i) const {
  float* s = store.raw[i].log_scale;
  if (config_.max_axis_ratio > 0) {
    const float low = std::min({s[0], s[1], s[2]}), high = std::max({s[0], s[1], s[2]});
    const float middle = s[0] + s[1] + s[2] - low - high;
    const float limit = middle + static_cast<float>(std::log(config_.max_axis_ratio));
    for (int k = 0; k < 3; ++k) s[k] = std::min(s[k], limit);
  }
  for (int k = 0; k < 3; ++k) s[k] = std::min(s[k], store.max_log_scale[i]);
  if (config_.max_flatness > 0) {
    const float low = std::min({s[0], s[1], s[2]}), high = std::max({s[0], s[1], s[2]});
    const float middle = s[0] + s[1] + s[2] - low - high;
    const float limit = middle - static_cast<float>(std::log(config_.max_flatness));
    for (int k = 0; k < 3; ++k) s[k] = std::max(s[k], limit);
  }
}

void Optimizer::step(const render::Gradients& gradients, map::GaussianStore& store) const {
  constexpr float kEpsilon = 1e-12f;
  const auto b1 = static_cast<float>(config_.beta1), b2 = static_cast<float>(config_.beta2);
  const auto ceiling = static_cast<float>(config_.average);
  for (std::size_t n = 0; n < gradients.visible.size(); ++n) {
    const std::size_t i = gradients.visible[n];
    const std::uint32_t t = store.steps[i]++;
    const std::size_t entry = std::min<std::size_t>(t, correction1_.size() - 1);
    const float c1 = correction1_[entry], c2 = correction2_[entry];
    const float* g = floats(gradients.gradient[n]);
    float* value = floats(store.raw[i]);
    float* m = floats(store.moment1[i]);
    float* v = floats(store.moment2[i]);
    for (std::size_t k = 0; k < kFields; ++k) {
      m[k] = b1 * m[k] + (1 - b1) * g[k];
      v[k] = b2 * v[k] + (1 - b2) * g[k] * g[k];
      value[k] -= rates_[k] * c1 * m[k] / (std::sqrt(v[k]) * c2 + kEpsilon);
    }
    cap(store, i);
    const float steps = static_cast<float>(t);
    const float d = std::min(ceiling, (steps + 1) / (steps + 10));
    float* average = floats(store.average[i]);
    for (std::size_t k = 0; k < kFields; ++k) average[k] = d * average[k] + (1 - d) * value[k];
  }
}

}  // namespace sgs::mapper
