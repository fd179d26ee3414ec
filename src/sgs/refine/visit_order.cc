// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/refine/visit_order.h"

#include <numeric>

#include "sgs/core/error.h"

namespace sgs::refine {

VisitOrder::VisitOrder(std::vector<double> weights, std::uint64_t seed)
    : weights_(std::move(weights)), random_(seed) {
  SGS_CHECK(!weights_.empty(), "an order needs something to order");
  const double sum = std::accumulate(weights_.begin(), weights_.end(), 0.0);
  for (double& weight : weights_) {
    SGS_CHECK(weight > 0, "weights are positive");
    weight /= sum;
    jitter_.push_back(random_.uniform());
  }
  credit_ = jitter_;
}

std::size_t VisitOrder::next() {
  std::size_t best = 0;
  for (std::size_t i = 0; i < weights_.size(); ++i) {
    credit_[i] += weights_[i];
    if (credit_[i] > credit_[best]) best = i;
  }
  // Drawn anew each time, so that frames do not follow each other in the same order for ever.
  const double jitter = random_.uniform();
  credit_[best] += jitter - jitter_[best] - 1;
  jitter_[best] = jitter;
  return best;
}

}  // namespace sgs::refine
