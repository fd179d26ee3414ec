// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/backend/online_calibration.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "sgs/backend/metre.h"
#include "sgs/backend/sure_calibration.h"
#include "sgs/core/log.h"

namespace sgs::backend {
namespace {

// Below all of these nothing that was tracked before would be different.
constexpr double kLeastChange_per_m = 2e-4;
constexpr double kLeastShift_px = 0.1;
constexpr double kLeastDelay_s = 5e-4;
constexpr double kSure_per_m = 5e-4;  // of the mean: more keyframes are not needed

/// Whether an estimate is sure enough to be acted on unasked.
bool is_sure_enough(const DepthEstimate& e) {
  constexpr double kLeastSure_per_m = 1.5e-3, kLeastSure_px = 0.5;
  return e.useful() && e.calibration.mean_sigma_per_m < kLeastSure_per_m &&
         e.calibration.shift_sigma_px.maxCoeff() < kLeastSure_px;
}

/// The same path in another scale; the first pose stays.
PoseCorrection rescaled(std::vector<MovedPose> poses, double scale) {
  const Eigen::Vector3d origin = poses.front().before.t;
  for (MovedPose& p : poses) {
    p.after = p.before;
    p.after.t = origin + scale * (p.before.t - origin);
  }
  return PoseCorrection(std::move(poses));
}

}  // namespace

bool confirms(const DepthCalibration& later, const DepthCalibration& earlier) {
  constexpr double kSigmas = 3;
  // Of no consequence, however sure one is.
  constexpr double kSame_per_m = 1e-4, kSame_px = 0.1, kSame_s = 5e-4;
  const double mean = later.mean_offset_per_m() - earlier.mean_offset_per_m();
  if (std::abs(mean) > kSigmas * earlier.mean_sigma_per_m + kSame_per_m) return false;
  const Eigen::Array2d shift = (later.shift_px - earlier.shift_px).array().abs();
  if ((shift > kSigmas * earlier.shift_sigma_px.array() + kSame_px).any()) return false;
  const double delay = std::abs(later.delay_s - earlier.delay_s);
  if (delay > kSigmas * earlier.delay_sigma_s + kSame_s) return false;
  const std::vector<double> area = later.grid.area();
  double chi2 = 0;
  for (std::size_t k = 0; k < area.size(); ++k) {
    const double off = later.offset_per_m[k] - mean - earlier.offset_per_m[k];
    const double sigma = earlier.sigma_per_m[k] + kSame_per_m;
    chi2 += area[k] * off * off / (sigma * sigma);
  }
  return chi2 < kSigmas;
}

OnlineCalibration::OnlineCalibration(const BackendConfig& config)
    : config_(config.calibration),
      archive_(config.archive),
      next_(static_cast<std::size_t>(config.calibration.first_keyframes)) {}

void OnlineCalibration::note_gap() { archive_.note_gap(); }

std::optional<LearnedCalibration> OnlineCalibration::add(
    const std::shared_ptr<const RgbdFrame>& raw, const history::Revision& revision,
    double readout_s, std::optional<double> tracked_delay_s) {
  if (done_) return std::nullopt;
  archive_.add(raw, revision.path);
  readout_s_ = readout_s;
  tracked_delay_s_ = tracked_delay_s;
  const bool in_flight = revision.calibrations < versions_;
  if (in_flight || asks_witnesses_ || archive_.keyframes().size() < next_) return std::nullopt;
  auto learned = learn(attempt(revision.path), revision);
  const auto enough = static_cast<std::size_t>(enough_keyframes());
  const bool sure = learned && learned->estimate.calibration.mean_sigma_per_m < kSure_per_m;
  asks_witnesses_ = next_ >= enough && versions_ == 0 && !contradicted_;
  done_ = contradicted_ || sure || (next_ >= enough && !asks_witnesses_);
  next_ = std::min(next_ + next_ / 2, enough);
  if (done_) archive_ = KeyframeArchive({});
  return learned;
}

// The second half costs thrice as much and adds little to what is known.
int OnlineCalibration::enough_keyframes() const {
  const int most = versions_ > 0 ? config_.keyframes / 2 : config_.keyframes;
  return std::max(most, config_.first_keyframes);
}

std::optional<LearnedCalibration> OnlineCalibration::finish(const history::Revision& revision) {
  const bool in_flight = revision.calibrations < versions_;
  if (done_ || in_flight) return std::nullopt;
  done_ = true;
  const std::size_t used = last_ ? static_cast<std::size_t>(last_->keyframes) : 0;
  if (!asks_witnesses_ && archive_.keyframes().size() >= used + used / 8 + 1) {
    if (auto learned = learn(attempt(revision.path), revision)) return learned;
  }
  if (versions_ > 0 || contradicted_) return std::nullopt;
  return learn(by_witnesses(revision.path), revision);
}

// What this attempt says, where the last one has said the same.
std::optional<DepthEstimate> OnlineCalibration::attempt(const history::Path& path) {
  CalibrationConfig config = config_;
  config.keyframes = enough_keyframes();
  DepthEstimate estimate =
      calibrate_depth(archive_.keyframes(), path, readout_s_, config, last_ ? &*last_ : nullptr);
  if (!estimate.why_not.empty()) return std::nullopt;
  estimate.tracked_delay_s = tracked_delay_s_;
  const auto last = std::exchange(last_, estimate);
  if (!last || !is_sure_enough(estimate)) return std::nullopt;
  if (confirms(estimate.calibration, last->calibration)) return estimate;
  log().info(
      "{} keyframes say something else of the depth camera than the first {} of them: no "
      "calibration is learned from them",
      estimate.keyframes, last->keyframes);
  return std::nullopt;
}

// Where no attempt was sure of itself, the parts of the whole recording are asked, as where it is
// calibrated on its own. At the end only: a change of depth and path on the way disturbs what comes
// after it, more than one of the first metres does.
std::optional<DepthEstimate> OnlineCalibration::by_witnesses(const history::Path& path) const {
  DepthEstimate sure = calibrate_surely(archive_.keyframes(), path, readout_s_, config_);
  sure.tracked_delay_s = tracked_delay_s_;
  if (sure.why_not.empty() && sure.useful()) return sure;
  if (!sure.refused.empty()) log().info("no calibration is learned: {}", sure.refused);
  return std::nullopt;
}

// Says so once.
bool OnlineCalibration::is_contradiction(const DepthEstimate& estimate, double scale) {
  std::vector<std::string> warnings = estimate.warnings();
  if (auto metre = metre_contradiction(
          estimate, scale_ * scale, mean_depth_share(estimate.calibration, archive_.keyframes()))) {
    warnings.push_back(std::move(*metre));
  }
  for (const std::string& warning : warnings) {
    log().warn("{}; no calibration is learned from this recording", warning);
  }
  contradicted_ = !warnings.empty();
  return contradicted_;
}

std::optional<LearnedCalibration> OnlineCalibration::learn(std::optional<DepthEstimate> estimate,
                                                           const history::Revision& revision) {
  if (!estimate) return std::nullopt;
  auto calibration = std::make_shared<const DepthCalibration>(estimate->calibration);
  const auto change = history::depth_change(revision.calibration, calibration);
  if (change->rms_per_m() < kLeastChange_per_m && change->shift_px() < kLeastShift_px &&
      std::abs(change->delay_s()) < kLeastDelay_s) {
    return std::nullopt;
  }
  const double scale = scale_of(estimate->poses);
  if (is_contradiction(*estimate, scale)) return std::nullopt;
  // Poses that were tracked with depth as it came are replaced by the adjusted ones; later ones,
  // tracked with depth nearly right, are surer than an adjustment of few pixels.
  PoseCorrection poses =
      versions_ == 0 ? PoseCorrection(estimate->poses) : rescaled(estimate->poses, scale);
  scale_ *= scale;
  ++versions_;
  return LearnedCalibration{std::move(*estimate), {std::move(poses), std::move(calibration)}};
}

}  // namespace sgs::backend
