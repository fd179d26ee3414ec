// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/map/mean_bounds.h"

#include <limits>

#include "sgs/core/error.h"

namespace sgs::map {

void MeanBounds::assign(std::span<const Gaussian> gaussians, std::span<const Gaussian> also) {
  SGS_CHECK(gaussians.size() == also.size(), "both arrays must hold the same Gaussians");
  size_ = 0;
  boxes_.clear();
  append(gaussians);
  for (std::size_t i = 0; i < also.size(); ++i) widen(i, also[i]);
}

void MeanBounds::append(std::span<const Gaussian> gaussians) {
  SGS_CHECK(gaussians.size() >= size_, "Gaussians have gone: assign() them");
  constexpr float kInf = std::numeric_limits<float>::infinity();
  boxes_.resize((gaussians.size() + kBlock - 1) / kBlock,
                {{kInf, kInf, kInf}, {-kInf, -kInf, -kInf}});
  for (std::size_t i = size_; i < gaussians.size(); ++i) widen(i, gaussians[i]);
  size_ = gaussians.size();
}

}  // namespace sgs::map
