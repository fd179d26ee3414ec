// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <memory>
#include <numbers>
#include <optional>

#include "sgs/core/random.h"
#include "sgs/tracker/odometry.h"

namespace sgs::tracker {

/// For tests and benchmarks: another tracker's poses with a drift added over the way that the
/// camera goes, a random walk and one that is the same everywhere. Shows what closing loops does,
/// however good the tracker.
class DriftingTracker : public Tracker {
 public:
  /// Standard deviations after one metre; both grow with the root of the way.
  struct Drift {
    double translation_m = 0.01;
    double rotation_deg = 0.5;
    /// Per metre: by how much each motion is too long, and the turn about the image's vertical.
    double length_ratio = 0, turn_deg = 0;
  };

  DriftingTracker(std::unique_ptr<Tracker> tracker, const Drift& drift, std::uint64_t seed)
      : odometry_(std::move(tracker)), drift_(drift), random_(seed) {}

  TrackResult track(const RgbdFrame& frame, const history::Revision& revision,
                    const map::SnapshotPtr& snapshot) override {
    TrackResult result = odometry_.track(frame, snapshot);
    if (!revision.path.empty()) drifted_ = revision.path.back().T_odom_camera;
    const SE3 T = result.T_odom_camera;
    if (!last_) {
      drifted_ = T;
    } else {
      SE3 motion = last_->inverse() * T;
      const double turn = motion.t.norm() * drift_.turn_deg * std::numbers::pi / 180;
      motion = SE3(motion.R * so3_exp({0, turn, 0}), (1 + drift_.length_ratio) * motion.t);
      drifted_ = (drifted_ * motion * SE3::exp(step(motion.t.norm()))).normalized();
    }
    last_ = T;
    result.T_odom_camera = drifted_;
    return result;
  }
  bool follows_map() const override { return odometry_.follows_map(); }

 private:
  double normal() {
    double sum = -6;
    for (int k = 0; k < 12; ++k) sum += random_.uniform();
    return sum;
  }
  Vector6d step(double way_m) {
    const double root = std::sqrt(way_m);
    const double turn = root * drift_.rotation_deg * std::numbers::pi / 180 / std::sqrt(3.0);
    const double shift = root * drift_.translation_m / std::sqrt(3.0);
    Vector6d xi;
    for (int k = 0; k < 6; ++k) xi[k] = (k < 3 ? turn : shift) * normal();
    return xi;
  }

  Odometry odometry_;  // its path has not drifted
  Drift drift_;
  SplitMix64 random_;
  std::optional<SE3> last_;
  SE3 drifted_;
};

}  // namespace sgs::tracker
