// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/synthetic/auto_exposure.h"

#include <algorithm>
#include <cmath>

namespace sgs::synthetic {

namespace {

double luma_of(const std::array<double, 3>& c) {
  return 0.299 * c[0] + 0.587 * c[1] + 0.114 * c[2];
}

// A plain view of nothing must not open the lens for ever.
constexpr double kDarkest = 1e-3;

}  // namespace

AutoExposure::AutoExposure(const ExposureModel& model, const ColorCamera& camera)
    : model_(model), camera_(camera) {
  exposure_.time_s = model.usual_s;
}

void AutoExposure::expose(double log_gain) {
  constexpr double kMost = 3;  // of the logarithm, from no gain: 26 dB
  log_gain_ = std::clamp(log_gain, -kMost, kMost);
  exposure_.gain = static_cast<float>(std::exp(log_gain_));
  exposure_.time_s = std::clamp(model_.usual_s * std::exp(log_gain_ - usual_log_gain_),
                                model_.shortest_s, model_.longest_s);
}

void AutoExposure::balance(const std::array<double, 3>& means, double rate) {
  constexpr double kStrongest = 0.4;  // logarithm of a cast that may be the light's
  for (std::size_t c : {std::size_t{0}, std::size_t{2}}) {
    // From the cast that is left to the one that is borne.
    const double cast = std::log(std::max(means[c], kDarkest) / std::max(means[1], kDarkest));
    const double balanced = std::log(double{exposure_.balance[c]});
    const double wanted = -model_.balance * std::clamp(cast - balanced, -kStrongest, kStrongest);
    exposure_.balance[c] = static_cast<float>(std::exp(balanced + rate * (wanted - balanced)));
  }
}

void AutoExposure::settle(const RayImage& view) {
  if (!model_.automatic) return;
  constexpr int kRounds = 20;
  for (int k = 0; k < kRounds; ++k) {
    const auto means = camera_.meter(view, exposure_);
    expose(log_gain_ + std::log(model_.target / std::max(luma_of(means), kDarkest)));
    balance(means, 0.5);
  }
  usual_log_gain_ = log_gain_;
  expose(log_gain_);
}

void AutoExposure::advance(const RayImage& view) {
  if (!model_.automatic) return;
  constexpr double kRight = 0.25;        // of what is borne: here a run of steps ends
  constexpr double kLightPerGrey = 1.5;  // steps of light that a step of grey takes, about
  const auto means = camera_.meter(view, exposure_);
  balance(means, model_.balance_rate);
  const double error = std::log(model_.target / std::max(luma_of(means), kDarkest));
  adjusting_ = std::abs(error) > (adjusting_ ? kRight * model_.hold : model_.hold);
  if (++since_step_ < model_.period || !adjusting_) return;
  since_step_ = 0;
  expose(log_gain_ + std::clamp(kLightPerGrey * error, -model_.largest_step, model_.largest_step));
}

}  // namespace sgs::synthetic
