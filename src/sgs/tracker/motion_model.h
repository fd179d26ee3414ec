// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/alignment/lost_reason.h"
#include "sgs/geometry/se3.h"
#include "sgs/tracker/tracker_config.h"

namespace sgs::tracker {

/// What every tracker knows about motion: where the next frame probably is, and which motions are
/// impossible. Holds the last trusted pose and counts the frames since.
class MotionModel {
 public:
  MotionModel(const MotionConfig& config, const SE3& T_start) : config_(config), T_(T_start) {}

  /// Start pose for a frame at `timestamp_s`: the last pose, moved on by the decayed last motion
  /// (scaled with the time passed).
  SE3 predict(double timestamp_s) const;
  /// Mean camera twist per second from the last trusted pose to `T` at `timestamp_s`; zero where
  /// that is unknown or long ago.
  Vector6d rate_to(const SE3& T, double timestamp_s) const;
  /// Camera twist per second as it was over the last few trusted frames, smoothed; zero where that
  /// is unknown or long ago. What is corrected by it does not depend on the pose that is sought.
  const Vector6d& steady_rate() const { return steady_rate_; }
  /// Whether going from the last trusted pose to `T` is possible: kNone, kNotFinite or
  /// kImplausibleMotion. After lost frames the limits grow with their number, up to max_growth
  /// times.
  alignment::LostReason judge(const SE3& T) const;
  /// Takes `T` as the trusted pose of the frame at `timestamp_s`. The motion after lost frames is
  /// no velocity.
  void accept(const SE3& T, double timestamp_s);
  /// Notes a frame without a trusted pose; predictions go on with the last velocity.
  void miss() { ++frames_held_; }
  /// The same, but the velocity is forgotten: predictions stay at the last pose.
  void hold();
  /// The last trusted pose was not quite right: goes on from `T` with the velocity it had.
  void correct(const SE3& T) { T_ = T; }
  /// The camera was found again, perhaps far away: motions are judged from `T` on.
  void jump_to(const SE3& T);

  const SE3& pose() const { return T_; }
  /// Of the last trusted pose.
  double timestamp_s() const { return timestamp_s_; }
  /// Frames since the last trusted pose.
  int frames_held() const { return frames_held_; }

 private:
  MotionConfig config_;
  SE3 T_;
  Vector6d velocity_ = Vector6d::Zero();  // of the last frame interval
  Vector6d steady_rate_ = Vector6d::Zero();
  double interval_s_ = 0;  // that it took; 0 = unknown
  double timestamp_s_ = 0;
  bool has_pose_ = false;
  int frames_held_ = 0;
};

}  // namespace sgs::tracker
