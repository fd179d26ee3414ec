// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "sgs/core/thread_pool.h"
#include "sgs/map/gaussian.h"
#include "sgs/map/harmonics.h"

namespace sgs::render {

/// The Gaussians with the colours that they show to a camera at `center` (world). A rasterizer
/// draws them as any others: it knows of one colour per Gaussian only. `harmonics` are those of
/// `gaussians`. They take no colour out of [0, 1]: other viewers clamp there, too. Same bits for
/// any number of threads.
void color_towards(std::span<const map::Gaussian> gaussians, const map::Harmonics& harmonics,
                   const Eigen::Vector3d& center, std::vector<map::Gaussian>& out,
                   ThreadPool* pool);

/// Gaussians as one camera sees them: the very same where their colours do not depend on it, else
/// a copy, which is kept in here until the next call.
class ViewColors {
 public:
  explicit ViewColors(ThreadPool* pool) : pool_(pool) {}
  std::span<const map::Gaussian> seen(std::span<const map::Gaussian> gaussians,
                                      const map::Harmonics& harmonics,
                                      const Eigen::Vector3d& center) {
    if (harmonics.empty()) return gaussians;
    color_towards(gaussians, harmonics, center, colored_, pool_);
    return colored_;
  }

 private:
  ThreadPool* pool_;
  std::vector<map::Gaussian> colored_;
};

/// Derivatives of the colour of one Gaussian seen from `center`. From the loss's derivative by that
/// colour (`row.rgb` of a gradient row): those by its coefficients, and what comes to `row.mean`,
/// because the direction turns as the mean moves. Where the colour is clamped, `row.rgb` becomes 0
/// unless it leads back.
void color_backward(const map::Gaussian& gaussian, std::span<const float> coefficients, int degree,
                    const Eigen::Vector3d& center, map::Gaussian& row, std::span<float> gradient);

/// Turns harmonics with their world: seen along R * d they look as they looked along d before.
/// Exact up to rounding, as a rotation mixes the functions of one degree only.
void turn_harmonics(const Eigen::Matrix3d& R, map::Harmonics& harmonics);

}  // namespace sgs::render
