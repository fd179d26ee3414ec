// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "sgs/map/gaussian_store.h"
#include "sgs/map/mean_bounds.h"
#include "sgs/mapper/adam.h"
#include "sgs/mapper/mapper_config.h"
#include "sgs/render/rasterizer.h"

namespace sgs::mapper {

/// Adam on the Gaussians that took part in a rendering, each with its own step count (Kingma & Ba
/// 2015; bias correction with the Gaussian's own t), followed by the caps and the average
///   avg <- d avg + (1 - d) value,  d = min(average, t / (t + 9)),
/// from step 16 on in every 4th step with d^4 (average 0: always the value itself). Moments are
/// kept as bfloat16, rounded so that the errors of many steps cancel: a step costs mostly the
/// memory it touches. Gaussians out of view cost nothing and keep their moments. Thread-safe for
/// disjoint Gaussians.
class Optimizer {
 public:
  explicit Optimizer(const OptimizerConfig& config);
  Optimizer(const Optimizer&) = delete;
  Optimizer& operator=(const Optimizer&) = delete;

  /// Other rates and caps from now on; `beta1`, `beta2` and `average` stay as they were.
  void set_rates(const OptimizerConfig& config);
  /// One step of the Gaussians `indices` of `store` along `rows`, one gradient each.
  void step(std::span<const std::uint32_t> indices, const map::Gaussian* rows,
            map::GaussianStore& store) const;

 private:
  AdamSettings settings_{};
  std::vector<float> correction1_, correction2_;  ///< 1/(1-b1^t), 1/sqrt(1-b2^t)
  std::vector<float> average_share_;              ///< 1 - d, see above
};

/// Makes room for `count` Gaussians in memory that the optimiser can walk through quickly.
void reserve(map::GaussianStore& store, std::size_t count);

/// Steps the Gaussians while a rasterizer's backward pass still has their gradients in the cache.
class StepWithBackward final : public render::GradientSink {
 public:
  /// All must outlive this; `store` keeps its size during the evaluation. `bounds` are widened
  /// where Gaussians move.
  StepWithBackward(const Optimizer& optimizer, map::GaussianStore& store, map::MeanBounds& bounds)
      : optimizer_(optimizer), store_(store), bounds_(bounds) {}
  void accept(std::span<const std::uint32_t> indices, const map::Gaussian* rows) override {
    optimizer_.step(indices, rows, store_);
    for (const std::uint32_t i : indices) bounds_.widen(i, store_.raw[i]);
  }

 private:
  const Optimizer& optimizer_;
  map::GaussianStore& store_;
  map::MeanBounds& bounds_;
};

}  // namespace sgs::mapper
