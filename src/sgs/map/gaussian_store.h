// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "sgs/map/gaussian.h"

namespace sgs::map {

/// Adam's state of one Gaussian: one cache line of bfloat16 numbers (the upper halves of floats),
/// in the order of Gaussian's floats. What a step costs is mostly the memory it touches.
struct alignas(64) Moments {
  std::uint16_t mean[16] = {};         ///< of the gradient
  std::uint16_t mean_square[16] = {};  ///< of its square
};
static_assert(sizeof(Moments) == 64);

/// The growing map with all that its optimiser keeps per Gaussian: parallel arrays of equal length,
/// in order of insertion (neighbours in space stay neighbours in memory). Not thread-safe.
struct GaussianStore {
  std::vector<Gaussian> raw;      ///< what is optimised
  std::vector<Gaussian> average;  ///< exponential average of `raw`: what everybody else reads
  std::vector<Moments> moments;
  std::vector<std::uint32_t> steps;  ///< optimisation steps of each Gaussian
  std::vector<float> max_log_scale;  ///< no axis may grow beyond this
  std::vector<Anchor> anchors;

  std::uint32_t next_id = 0;  ///< Anchor::id of the next one

  std::size_t size() const { return raw.size(); }
  /// Adds a Gaussian; its average starts at its value, its moments at zero. Its anchor gets an id.
  void append(const Gaussian& gaussian, const Anchor& anchor, float largest_log_scale);
  /// Removes those for which `remove(i)` is true, keeping the order; returns how many.
  std::size_t remove_if(const std::function<bool(std::size_t)>& remove);
};

}  // namespace sgs::map
