// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "sgs/map/gaussian.h"

namespace sgs::map {

/// The growing map with all that its optimiser keeps per Gaussian: parallel arrays of equal length,
/// in order of insertion (neighbours in space stay neighbours in memory). Not thread-safe.
struct GaussianStore {
  std::vector<Gaussian> raw;         ///< what is optimised
  std::vector<Gaussian> average;     ///< exponential average of `raw`: what everybody else reads
  std::vector<Gaussian> moment1;     ///< Adam: mean of the gradient
  std::vector<Gaussian> moment2;     ///< Adam: mean of its square
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
