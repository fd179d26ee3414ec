// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/geometry/se3.h"

namespace sgs::registration {

/// How the camera moves while one picture is read out, first row to last: a rolling shutter sees
/// each row from its own pose, T exp(o delta), o = -0.5 .. 0.5 from the first row to the last, T
/// the pose of the middle row. First order in delta: a readout takes some 10 ms, in which a
/// hand-held camera turns by some milliradians. Zero = global shutter.
///
/// Why it matters: across a plane, turning and shifting differ in the second order of the image
/// coordinates only, which is where a rolling shutter bends the picture as well. Unmodelled, a 16
/// ms readout costs centimetres in front of a wall (docs/decisions/0001-rolling-shutter.md).
class ReadoutMotion {
 public:
  ReadoutMotion() = default;
  /// `delta`: camera twist over the whole readout, rotation first, rad and m.
  explicit ReadoutMotion(const Vector6d& delta)
      : rotation_(delta.head<3>().cast<float>()), translation_(delta.tail<3>().cast<float>()) {}

  /// Place of a row in the readout.
  static float offset(float row, int height) {
    return (row + 0.5f) / static_cast<float>(height) - 0.5f;
  }
  /// Coordinates in the middle row's camera of a point that the row at `offset` sees at `p_row`.
  Eigen::Vector3f to_middle(const Eigen::Vector3f& p_row, float offset) const {
    return p_row + offset * (rotation_.cross(p_row) + translation_);
  }
  /// The inverse.
  Eigen::Vector3f to_row(const Eigen::Vector3f& p_middle, float offset) const {
    return p_middle - offset * (rotation_.cross(p_middle) + translation_);
  }
  Eigen::Vector3f direction_to_middle(const Eigen::Vector3f& n_row, float offset) const {
    return (n_row + offset * rotation_.cross(n_row)).normalized();
  }
  const Eigen::Vector3f& rotation() const { return rotation_; }
  const Eigen::Vector3f& translation() const { return translation_; }

 private:
  Eigen::Vector3f rotation_ = Eigen::Vector3f::Zero();
  Eigen::Vector3f translation_ = Eigen::Vector3f::Zero();
};

/// How the camera moved while one frame was measured: twists of the camera, rotation first.
struct FrameMotion {
  Vector6d readout = Vector6d::Zero();   ///< from the first row of the picture to the last
  Vector6d velocity = Vector6d::Zero();  ///< per second
  double depth_delay_s = 0;              ///< by how much later than its colour a row is measured
  double learned_delay_s = 0;            ///< of that, what neither stamps nor a calibration told

  /// From a row's colour to its depth.
  Vector6d lag() const { return depth_delay_s * velocity; }
  /// A calibration tells the delay, `later_s` more than the one before: that takes the place of
  /// what was learned. Returns the camera's twist over the time by which the delay grows.
  Vector6d recalibrate(double later_s) {
    const double grows_s = later_s - learned_delay_s;
    depth_delay_s += grows_s;
    learned_delay_s = 0;
    return grows_s * velocity;
  }
};

}  // namespace sgs::registration
