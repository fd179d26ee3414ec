// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/backend/sure_calibration.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "sgs/backend/held_out_fit.h"
#include "sgs/backend/metre.h"
#include "sgs/core/log.h"

namespace sgs::backend {
namespace {

constexpr CalibrationParts kAllParts{true, true, true, true};
constexpr int kFewestOfHalf = 4;  // keyframes

using Halves = std::array<KeyframeList, 2>;

Halves halves_in_time(const KeyframeList& all) {
  const auto middle = all.begin() + std::ssize(all) / 2;
  return {KeyframeList(all.begin(), middle), KeyframeList(middle, all.end())};
}

/// Stretches in turns; long enough for neighbours to lie in the same one.
Halves stretches_in_turns(const KeyframeList& all) {
  constexpr std::size_t kShortest = 4, kMostStretches = 12;
  const std::size_t length = std::max(kShortest, all.size() / kMostStretches);
  Halves out;
  for (std::size_t k = 0; k < all.size(); ++k) out[k / length % 2].push_back(all[k]);
  return out;
}

/// Two halves, and what each says on its own.
struct Pair {
  Halves keyframes;
  std::array<DepthEstimate, 2> said;

  bool complete() const { return said[0].why_not.empty() && said[1].why_not.empty(); }
};

/// A recording that is asked in parts, all with the same held.
class Witnesses {
 public:
  Witnesses(const KeyframeList& all, double readout_s, CalibrationConfig config)
      : readout_s_(readout_s), config_(std::move(config)) {
    config_.keyframes = std::max(config_.keyframes / 2, kFewestOfHalf);
    in_time_.keyframes = halves_in_time(all);
    in_turns_.keyframes = stretches_in_turns(all);
    for (Pair* pair : {&in_time_, &in_turns_}) {
      for (KeyframeList& half : pair->keyframes) half = thinned(half, config_.keyframes);
    }
  }

  /// Asks all halves again. False where one of them does not tell.
  bool ask(const CalibrationParts& held) {
    for (Pair* pair : {&in_time_, &in_turns_}) {
      for (std::size_t k = 0; k < 2; ++k) {
        pair->said[k] =
            calibrate_depth(pair->keyframes[k], readout_s_, config_, held, nullptr, kFewestOfHalf);
      }
      if (!pair->complete()) return false;
    }
    return true;
  }
  std::array<Disagreement, 2> disagreements() const {
    return {compare(in_time_.said[0].free, in_time_.said[1].free),
            compare(in_turns_.said[0].free, in_turns_.said[1].free)};
  }
  /// Whether stretches fit better with what the others say of some parts.
  bool fit_better(const CalibrationParts& parts) const;

 private:
  double readout_s_;
  CalibrationConfig config_;
  Pair in_time_, in_turns_;
};

/// Some parts of what keyframes say, significant or not.
DepthCalibration calibration_of(const DepthEstimate& said, const CalibrationParts& parts) {
  DepthCalibration c = said.calibration;
  const FreeEstimate& free = said.free;
  for (std::size_t k = 0; k < c.offset_per_m.size(); ++k) {
    c.offset_per_m[k] =
        (parts.shape ? free.shape_per_m[k] : 0) + (parts.mean ? free.mean_per_m : 0);
  }
  c.shift_px = parts.shift ? free.shift_px : Eigen::Vector2d::Zero();
  c.delay_s = parts.delay ? free.delay_s : 0;
  return c;
}

bool Witnesses::fit_better(const CalibrationParts& parts) const {
  Fit with, without;
  for (std::size_t k = 0; k < 2; ++k) {
    const KeyframeList& judges = in_turns_.keyframes[1 - k];
    const BundleNoise& noise = in_turns_.said[1 - k].noise;
    const auto fit = [&](const CalibrationParts& used) {
      return fit_with(calibration_of(in_turns_.said[k], used), judges, readout_s_, config_, noise);
    };
    const auto used = fit(parts), unused = fit({});
    if (!used || !unused) return false;
    with = with + *used;
    without = without + *unused;
  }
  log().info(
      "stretches held out cost {:.3f} (pictures) and {:.3f} (depth) a residual with what the "
      "others say, {:.3f} and {:.3f} without",
      with.grey, with.depth, without.grey, without.depth);
  return fits_better(with, without);
}

/// Deviations are not below half of what halves differ by, nor below what was known before some
/// parts were held.
void widen(const FreeEstimate& before, const std::array<Disagreement, 2>& disagreements,
           DepthCalibration& c) {
  const auto at_least = [](double least, double& sigma) { sigma = std::max(sigma, least); };
  at_least(before.mean_sigma_per_m, c.mean_sigma_per_m);
  at_least(before.delay_sigma_s, c.delay_sigma_s);
  c.shift_sigma_px = c.shift_sigma_px.cwiseMax(before.shift_covariance.diagonal().cwiseSqrt());
  for (std::size_t k = 0; k < c.sigma_per_m.size(); ++k) {
    at_least(std::hypot(before.mean_sigma_per_m, before.shape_sigma_per_m[k]), c.sigma_per_m[k]);
  }
  for (const Disagreement& d : disagreements) {
    at_least(d.mean.half, c.mean_sigma_per_m);
    at_least(d.delay.half, c.delay_sigma_s);
    c.shift_sigma_px = c.shift_sigma_px.cwiseMax(d.half_shift_px);
    for (std::size_t k = 0; k < c.sigma_per_m.size(); ++k) {
      at_least(std::hypot(d.mean.half, d.half_shape_per_m[k]), c.sigma_per_m[k]);
    }
  }
}

void note(const std::array<Disagreement, 2>& disagreements) {
  const std::array names{"halves in time", "stretches in turns"};
  for (std::size_t k = 0; k < 2; ++k) {
    const Disagreement& d = disagreements[k];
    log().info(
        "{} differ by {:.1f} deviations in the mean offset, {:.1f} in its shape, {:.1f} in the "
        "shift, {:.1f} in the delay ({:.1f} ms)",
        names[k], d.mean.sigmas, d.shape.sigmas, d.shift.sigmas, d.delay.sigmas,
        2e3 * d.delay.half);
  }
}

}  // namespace

DepthEstimate calibrate_surely(const std::vector<Keyframe>& all, const history::Path& path,
                               double readout_s, const CalibrationConfig& config) {
  const KeyframeList useful = useful_keyframes(all, path);
  DepthEstimate whole = calibrate_depth(useful, readout_s, config);
  if (!whole.useful()) return whole;
  const FreeEstimate before = whole.free;
  Witnesses witnesses(useful, readout_s, config);
  std::vector<std::array<Disagreement, 2>> rounds;
  CalibrationParts contradictions;
  while (whole.known.any()) {
    const CalibrationParts believed = whole.known, held = without(kAllParts, believed);
    if (!witnesses.ask(held)) {
      whole.refused = "one half of the recording alone does not tell";
      return whole;
    }
    const auto disagreements = witnesses.disagreements();
    note(disagreements);
    widen(before, disagreements, whole.calibration);
    rounds.push_back(disagreements);
    const CalibrationParts now =
        (contradicted(disagreements[0]) | contradicted(disagreements[1])) & believed;
    if (!now.any()) break;
    contradictions = contradictions | now;
    DepthEstimate rest = calibrate_depth(useful, readout_s, config, held | now, &whole);
    if (!rest.why_not.empty()) return rest;
    for (const auto& round : rounds) widen(before, round, rest.calibration);
    whole = std::move(rest);
  }
  whole.contradicted = contradictions;
  if (!whole.known.any()) {
    whole.refused = fmt::format("two halves of the recording contradict each other ({})",
                                contradictions.names());
  } else if (!witnesses.fit_better(whole.known)) {
    whole.refused = "parts of the recording fit no better with what the other parts say";
  } else if (auto metre = metre_contradiction(whole, scale_of(whole.poses),
                                              rms_depth_share(whole.calibration, all))) {
    whole.refused = std::move(*metre);
  }
  return whole;
}

}  // namespace sgs::backend
