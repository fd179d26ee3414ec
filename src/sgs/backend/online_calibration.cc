// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/backend/online_calibration.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sgs/core/log.h"

namespace sgs::backend {
namespace {

// Below either of these nothing that was tracked before would be different.
constexpr double kLeastChange_per_m = 2e-4;
constexpr double kLeastShift_px = 0.1;
constexpr double kSure_per_m = 5e-4;  // of the mean: more keyframes are not needed
// A depth camera that is off by more is not a little distorted but something else.
constexpr double kContradiction = 0.015;

/// Whether an estimate is sure enough to be acted on unasked, and its camera one that the model
/// describes.
bool can_be_relied_on(const DepthEstimate& e) {
  constexpr double kLeastSure_per_m = 1.5e-3, kLeastSure_px = 0.5;
  return e.useful() && e.warnings().empty() && e.calibration.mean_sigma_per_m < kLeastSure_per_m &&
         e.calibration.shift_sigma_px.maxCoeff() < kLeastSure_px;
}

/// By how much the path grows, about its middle.
double scale_of(const std::vector<MovedPose>& poses) {
  Eigen::Vector3d before = Eigen::Vector3d::Zero(), after = Eigen::Vector3d::Zero();
  for (const MovedPose& p : poses) {
    before += p.before.t / static_cast<double>(poses.size());
    after += p.after.t / static_cast<double>(poses.size());
  }
  double square = 0, product = 0;
  for (const MovedPose& p : poses) {
    square += (p.before.t - before).squaredNorm();
    product += (p.before.t - before).dot(p.after.t - after);
  }
  return square > 0 ? product / square : 1;
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
  constexpr double kSame_per_m = 1e-4, kSame_px = 0.1;  // of no consequence, however sure one is
  const double mean = later.mean_offset_per_m() - earlier.mean_offset_per_m();
  if (std::abs(mean) > kSigmas * earlier.mean_sigma_per_m + kSame_per_m) return false;
  const Eigen::Array2d shift = (later.shift_px - earlier.shift_px).array().abs();
  if ((shift > kSigmas * earlier.shift_sigma_px.array() + kSame_px).any()) return false;
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
      next_(static_cast<std::size_t>(config.calibration.first_keyframes)) {
  // Half of what a batch adjusts: the second half costs thrice as much and adds little.
  config_.keyframes = std::max(config_.keyframes / 2, config.calibration.first_keyframes);
}

std::optional<LearnedCalibration> OnlineCalibration::add(
    const std::shared_ptr<const RgbdFrame>& raw, const std::optional<SE3>& T_world_camera,
    double readout_s) {
  if (done_) return std::nullopt;
  if (!T_world_camera) {
    archive_.note_gap();
    return std::nullopt;
  }
  archive_.add(raw, *T_world_camera);
  readout_s_ = readout_s;
  if (in_flight_ || archive_.keyframes().size() < next_) return std::nullopt;
  auto learned = learn();
  const auto most = static_cast<std::size_t>(config_.keyframes);
  const bool sure = learned && learned->estimate.calibration.mean_sigma_per_m < kSure_per_m;
  done_ = contradicted_ || sure || next_ >= most;
  next_ = std::min(next_ + next_ / 2, most);
  if (done_) archive_ = KeyframeArchive({});
  return learned;
}

std::optional<LearnedCalibration> OnlineCalibration::finish() {
  const std::size_t used = last_ ? static_cast<std::size_t>(last_->keyframes) : 0;
  if (done_ || in_flight_ || archive_.keyframes().size() < used + used / 8 + 1) return std::nullopt;
  done_ = true;
  return learn();
}

std::optional<LearnedCalibration> OnlineCalibration::learn() {
  LearnedCalibration out;
  out.estimate = calibrate_depth(archive_.keyframes(), readout_s_, config_);
  log().debug(
      "calibration from {} of {} keyframes: {} mean {:+.5f} /m (sigma {:.5f}), shift {:+.2f} "
      "{:+.2f} px (sigma {:.2f} {:.2f}) {}",
      out.estimate.keyframes, archive_.keyframes().size(),
      out.estimate.useful() ? "useful," : "not useful,",
      out.estimate.calibration.mean_offset_per_m(), out.estimate.calibration.mean_sigma_per_m,
      out.estimate.calibration.shift_px.x(), out.estimate.calibration.shift_px.y(),
      out.estimate.calibration.shift_sigma_px.x(), out.estimate.calibration.shift_sigma_px.y(),
      out.estimate.why_not);
  if (!out.estimate.why_not.empty()) return std::nullopt;
  const auto last = std::exchange(last_, out.estimate);
  if (!last || !can_be_relied_on(out.estimate)) return std::nullopt;
  if (!confirms(out.estimate.calibration, last->calibration)) {
    log().info(
        "{} keyframes say something else of the depth camera than the first {} of them: no "
        "calibration is learned from them",
        out.estimate.keyframes, last->keyframes);
    return std::nullopt;
  }
  auto change = std::make_shared<const DepthChange>(current_, out.estimate.calibration);
  if (change->rms_per_m() < kLeastChange_per_m && change->shift_px() < kLeastShift_px) {
    return std::nullopt;
  }
  const double scale = scale_of(out.estimate.poses);
  if (std::abs(scale_ * scale - 1) > kContradiction) {
    log().warn(
        "pictures and depth disagree on the metre by {:.1f} %: the intrinsics or the registration "
        "of the two cameras are probably wrong; depth is used as it is",
        100 * std::abs(scale_ * scale - 1));
    contradicted_ = true;
    return std::nullopt;
  }
  // Poses that were tracked with depth as it came are replaced by the adjusted ones; later ones,
  // tracked with depth nearly right, are surer than an adjustment of few pixels.
  out.correction = {
      versions_ == 0 ? PoseCorrection(out.estimate.poses) : rescaled(out.estimate.poses, scale),
      std::move(change)};
  scale_ *= scale;
  current_ = out.estimate.calibration;
  in_flight_ = true;
  ++versions_;
  return out;
}

void OnlineCalibration::note_applied(const PastCorrection& correction) {
  archive_.correct(correction);
  if (correction.depth) in_flight_ = false;
}

}  // namespace sgs::backend
