// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "sgs/map/gaussian_store.h"

namespace sgs::mapper {

/// What one step does to every Gaussian it reaches (see Optimizer). Plain data, shared by the
/// kernels of all instruction sets.
struct AdamSettings {
  /// The average of a Gaussian that has had a few steps is updated in every n-th of them: it is one
  /// of four cache lines that a step touches.
  static constexpr std::uint32_t kAverageInterval = 4;
  alignas(64) float rate[16];  ///< per float of a row, 0 for the unused ones
  float beta1 = 0, beta2 = 0;
  float log_axis_ratio = 0;  ///< largest over middle axis at most, logarithm; infinity = free
  float log_flatness = 0;    ///< middle over smallest axis at most, logarithm; infinity = free
  const float* correction1 = nullptr;    ///< 1 / (1 - beta1^t) at t - 1
  const float* correction2 = nullptr;    ///< 1 / sqrt(1 - beta2^t)
  const float* average_share = nullptr;  ///< of the new value in the average; 0 = not now
  std::uint32_t table_size = 0;          ///< of all three, a multiple of kAverageInterval; the last
                                         ///< kAverageInterval entries stand for the rest
};

/// Rows of the Gaussians, indexed alike.
struct AdamRows {
  map::Gaussian* value = nullptr;
  map::Gaussian* average = nullptr;
  map::Moments* moments = nullptr;
  std::uint32_t* steps = nullptr;
  const float* max_log_scale = nullptr;
};

/// One step of the Gaussians `indices` along `gradient` (one row each). Thread-safe for disjoint
/// indices.
void adam_step(const AdamSettings& settings, const AdamRows& rows, const std::uint32_t* indices,
               const map::Gaussian* gradient, std::size_t count);

}  // namespace sgs::mapper
