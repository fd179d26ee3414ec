// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapper/optimizer.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sgs/core/huge_pages.h"

namespace sgs::mapper {
namespace {

float log_limit(double ratio) {
  return ratio > 0 ? static_cast<float>(std::log(ratio)) : std::numeric_limits<float>::infinity();
}

}  // namespace

Optimizer::Optimizer(const OptimizerConfig& config) {
  set_rates(config);
  settings_.beta1 = static_cast<float>(config.beta1);
  settings_.beta2 = static_cast<float>(config.beta2);
  // Beyond the table both corrections are 1 to float precision for the usual betas.
  constexpr int kTable = 8192;
  constexpr int kEveryStep = 16;  // before this the average follows every step
  for (int t = 1; t <= kTable; ++t) {
    correction1_.push_back(static_cast<float>(1 / (1 - std::pow(config.beta1, t))));
    correction2_.push_back(static_cast<float>(1 / std::sqrt(1 - std::pow(config.beta2, t))));
    const double kept = std::min(config.average, t / (t + 9.0));
    const bool every_step = t < kEveryStep || config.average == 0;
    const int interval = every_step ? 1 : AdamSettings::kAverageInterval;
    average_share_.push_back(t % interval == 0 ? static_cast<float>(1 - std::pow(kept, interval))
                                               : 0.0f);
  }
  settings_.correction1 = correction1_.data();
  settings_.correction2 = correction2_.data();
  settings_.average_share = average_share_.data();
  settings_.table_size = kTable;
}

void Optimizer::set_rates(const OptimizerConfig& config) {
  const auto fill = [this](std::size_t from, std::size_t count, double rate) {
    std::fill_n(settings_.rate + from, count, static_cast<float>(rate));
  };
  fill(0, 3, config.rate_mean_m);
  fill(3, 3, config.rate_log_scale);
  fill(6, 4, config.rate_rotation);
  fill(10, 1, config.rate_opacity);
  fill(11, 3, config.rate_color);
  fill(14, 2, 0);
  settings_.log_axis_ratio = log_limit(config.max_axis_ratio);
  settings_.log_flatness = log_limit(config.max_flatness);
}

void Optimizer::step(std::span<const std::uint32_t> indices, const map::Gaussian* rows,
                     map::GaussianStore& store) const {
  const AdamRows all = {store.raw.data(), store.average.data(), store.moments.data(),
                        store.steps.data(), store.max_log_scale.data()};
  adam_step(settings_, all, indices.data(), rows, indices.size());
}

void reserve(map::GaussianStore& store, std::size_t count) {
  for (auto* rows : {&store.raw, &store.average}) reserve_huge(*rows, count);
  reserve_huge(store.moments, count);
  reserve_huge(store.anchors, count);
  reserve_huge(store.steps, count);
  reserve_huge(store.max_log_scale, count);
}

}  // namespace sgs::mapper
