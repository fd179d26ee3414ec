// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/alignment/readout_estimator.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace sgs::alignment {
namespace {

constexpr double kLongest_s = 0.04;
// What calibration, lens and depth errors look like within one picture: no frame says more.
constexpr double kFloor_rad = 1e-3;
constexpr double kUseful_rad = 1e-3;
constexpr double kLargest_rad = 0.05;
constexpr double kMostScatter_rad = 5e-3;
// Pixels share blur, lens and depth errors, so their number overstates what a picture knows about
// the readout; the belief is weighted up accordingly.
constexpr double kOverconfidence = 10;
// Where nothing is unknown the prior must stay finite.
constexpr double kTiny_rad = 1e-5;

}  // namespace

ReadoutEstimator::ReadoutEstimator(const ReadoutConfig& config)
    : config_(config),
      information_(1 / (config.prior_sigma_s * config.prior_sigma_s)),
      scatter_(config.prior_sigma_s * config.rate_sigma * config.prior_sigma_s *
               config.rate_sigma) {}

double ReadoutEstimator::readout_s() const {
  if (!config_.estimate) return config_.fixed_s;
  return std::clamp(moment_ / information_, -kLongest_s, kLongest_s);
}

ReadoutEstimator::Keyframe ReadoutEstimator::keyframe_or_still(std::size_t keyframe) const {
  return keyframe < keyframes_.size() ? keyframes_[keyframe] : Keyframe{};
}

void ReadoutEstimator::add_keyframe(std::size_t keyframe, const Eigen::Vector3d& turning_rate,
                                    const Eigen::Vector3d& rotation) {
  if (!turning_rate.allFinite() || !rotation.allFinite()) return;
  const Eigen::Vector3d none = Eigen::Vector3d::Zero();
  if (keyframe >= keyframes_.size()) keyframes_.resize(keyframe + 1, {none, none, none, scatter_});
  keyframes_[keyframe] = {turning_rate, rotation, none, scatter_};
  if (aligned_to_ == keyframe) aligned_to_.reset();
}

Eigen::Vector3d ReadoutEstimator::keyframe_error(std::size_t keyframe) const {
  if (!config_.estimate) return Eigen::Vector3d::Zero();
  const Keyframe k = keyframe_or_still(keyframe);
  return k.rotation - readout_s() * k.turning_rate + k.short_by;
}

ReadoutEstimator::Belief ReadoutEstimator::predict(const Vector6d& velocity,
                                                   std::size_t keyframe) const {
  Belief belief;
  belief.mean = readout_s() * velocity;
  double variance = kTiny_rad * kTiny_rad;
  if (config_.estimate) {
    belief.mean.head<3>() += keyframe_error(keyframe);
    const Eigen::Vector3d rate = velocity.head<3>() - keyframe_or_still(keyframe).turning_rate;
    variance += 2 * scatter_ + rate.squaredNorm() / information_;
  }
  belief.information.diagonal().setConstant(kOverconfidence / variance);
  return belief;
}

// What tau and the error of the last keyframe had in common is left behind with that keyframe.
void ReadoutEstimator::begin(std::size_t keyframe) {
  const Keyframe& k = keyframes_[keyframe];
  const double known = 1 / std::max(k.variance, kTiny_rad * kTiny_rad);
  joint_.information = Eigen::Vector4d(information_, known, known, known).asDiagonal();
  joint_.moment << moment_, known * k.short_by;
  aligned_to_ = keyframe;
}

void ReadoutEstimator::update(const Eigen::Vector3d& turning_rate, const Eigen::Vector3d& rotation,
                              const Eigen::Matrix3d& information, std::size_t keyframe) {
  if (!config_.estimate || !turning_rate.allFinite() || !rotation.allFinite()) return;
  Eigen::Matrix3d covariance = information.inverse();
  // Too little texture to tell a turn from a change of the picture.
  if (!(covariance.diagonal().maxCoeff() < kUseful_rad * kUseful_rad) ||
      !(covariance.diagonal().minCoeff() > 0) || rotation.norm() > kLargest_rad) {
    last_off_.reset();
    return;
  }
  const double measured = covariance.trace() / 3;
  covariance.diagonal().array() += kFloor_rad * kFloor_rad + scatter_;
  const Eigen::Matrix3d weight = covariance.inverse();
  if (keyframe >= keyframes_.size()) add_keyframe(keyframe, {0, 0, 0}, {0, 0, 0});
  Keyframe& k = keyframes_[keyframe];
  const Eigen::Vector3d rate = turning_rate - k.turning_rate, turn = rotation - k.rotation;
  if (aligned_to_ != keyframe) begin(keyframe);
  Eigen::Matrix<double, 3, 4> J;
  J << rate, Eigen::Matrix3d::Identity();
  Joint joint = joint_;
  joint.information += J.transpose() * weight * J;
  joint.moment += J.transpose() * (weight * turn);
  const Eigen::Matrix4d both = joint.information.inverse();
  const Eigen::Vector4d estimate = both * joint.moment;
  if (!(both(0, 0) > 0) || !estimate.allFinite()) return;
  joint_ = joint;
  information_ = 1 / both(0, 0);
  moment_ = information_ * estimate(0);
  k.short_by = estimate.tail<3>();
  k.variance = both.diagonal().tail<3>().mean();
  const Eigen::Vector3d off = turn - readout_s() * rate - k.short_by;

  if (last_off_) {
    constexpr double kForget = 1.0 / 30;
    const double change = (off - *last_off_).squaredNorm() / 6;  // three axes, two frames
    const double most = kMostScatter_rad * kMostScatter_rad;
    scatter_ += kForget * (std::clamp(change - measured, 0.0, most) - scatter_);
  }
  last_off_ = off;
}

}  // namespace sgs::alignment
