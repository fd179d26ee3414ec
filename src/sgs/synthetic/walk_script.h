// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sgs/geometry/trajectory.h"
#include "sgs/synthetic/body.h"

namespace sgs::synthetic {

/// The floor before a camera as people walk on it: where the camera is and looks, horizontally and
/// evened over seconds, so that nobody moves with the camera's own trembling and turning.
class Stage {
 public:
  explicit Stage(const Trajectory& motion);
  double start_s() const { return start_s_; }
  double end_s() const;
  /// A place on the floor, metres to the right and ahead of the camera, in the world at that time.
  Eigen::Vector2f in_world(const Eigen::Vector2f& right_ahead, double time_s) const;
  /// Angle in the world of what faces the camera.
  float towards_camera(double time_s) const;

 private:
  Eigen::Vector4f at(double time_s) const;
  double start_s_ = 0;
  std::vector<Eigen::Vector4f> views_;  // eye and heading, ten a second
};

/// Where on the floor somebody is to be, and when.
struct Stop {
  double time_s = 0;
  Eigen::Vector2f place;  ///< in the world, metres; straight on between two stops
  bool sits = false;      ///< until the next stop
};

/// Somebody's way from stop to stop.
class WalkScript {
 public:
  /// Over the times of the stage. `faces_camera`: whichever way they walk.
  WalkScript(const Stage& stage, const std::vector<Stop>& stops, bool faces_camera);
  /// Before and after the stage's times as at its ends.
  Posture at(double time_s) const;

 private:
  double start_s_;
  std::vector<Posture> postures_;  // sixty a second, angles unwrapped
};

}  // namespace sgs::synthetic
