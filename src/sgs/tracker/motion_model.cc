// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/tracker/motion_model.h"

#include <algorithm>

namespace sgs::tracker {
namespace {
constexpr double kRateShare = 0.5;       // of the last interval in the steady rate
constexpr double kMaxIntervalRatio = 3;  // dropped frames; beyond, the velocity says little
}  // namespace

SE3 MotionModel::predict(double timestamp_s) const {
  if (config_.start == MotionStart::kPrevious || interval_s_ <= 0) return T_;
  const double ratio =
      std::clamp((timestamp_s - timestamp_s_) / interval_s_, 0.0, kMaxIntervalRatio);
  return T_ * SE3::exp(config_.velocity_decay * ratio * velocity_);
}

Vector6d MotionModel::rate_to(const SE3& T, double timestamp_s) const {
  constexpr double kLongest_s = 0.2;
  const double dt = timestamp_s - timestamp_s_;
  if (!has_pose_ || !(dt > 0) || dt > kLongest_s) return Vector6d::Zero();
  return (T_.inverse() * T).log() / dt;
}

alignment::LostReason MotionModel::judge(const SE3& T) const {
  if (!T.all_finite()) return alignment::LostReason::kNotFinite;
  const SE3 motion = T_.inverse() * T;
  const double growth = std::min(frames_held_ + 1, config_.max_growth);
  const bool possible = motion.t.norm() <= growth * config_.max_translation_m &&
                        motion.angle() <= growth * config_.max_rotation_rad;
  return possible ? alignment::LostReason::kNone : alignment::LostReason::kImplausibleMotion;
}

void MotionModel::accept(const SE3& T, double timestamp_s) {
  const Vector6d rate = rate_to(T, timestamp_s);
  const bool consecutive = has_pose_ && frames_held_ == 0 && timestamp_s > timestamp_s_;
  velocity_ = consecutive ? (T_.inverse() * T).log() : Vector6d::Zero();
  interval_s_ = consecutive ? timestamp_s - timestamp_s_ : 0;
  const bool goes_on = consecutive && !steady_rate_.isZero(0) && !rate.isZero(0);
  steady_rate_ = goes_on       ? Vector6d(steady_rate_ + kRateShare * (rate - steady_rate_))
                 : consecutive ? rate
                               : Vector6d(Vector6d::Zero());
  T_ = T;
  timestamp_s_ = timestamp_s;
  has_pose_ = true;
  frames_held_ = 0;
}

void MotionModel::hold() {
  ++frames_held_;
  velocity_.setZero();
  steady_rate_.setZero();
  interval_s_ = 0;
}

void MotionModel::jump_to(const SE3& T) {
  T_ = T;
  velocity_.setZero();
  steady_rate_.setZero();
  interval_s_ = 0;
  has_pose_ = false;
}

}  // namespace sgs::tracker
