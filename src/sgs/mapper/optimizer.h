// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/map/gaussian_store.h"
#include "sgs/mapper/mapper_config.h"
#include "sgs/render/rasterizer.h"

namespace sgs::mapper {

/// Adam on the Gaussians that took part in a rendering, each with its own step count (Kingma & Ba
/// 2015; bias correction with the Gaussian's own t), followed by the caps and the average
///   avg <- d avg + (1 - d) value,  d = min(average, (t + 1) / (t + 10)).
/// Gaussians out of view cost nothing and keep their moments.
class Optimizer {
 public:
  explicit Optimizer(const OptimizerConfig& config);

  /// One step along `gradients` (whose indices refer to `store`).
  void step(const render::Gradients& gradients, map::GaussianStore& store) const;

 private:
  void cap(map::GaussianStore& store, std::size_t i) const;

  OptimizerConfig config_;
  float rates_[16];
  std::vector<float> correction1_, correction2_;  ///< 1/(1-b1^t), 1/sqrt(1-b2^t)
};

}  // namespace sgs::mapper
