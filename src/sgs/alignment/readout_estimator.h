// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "sgs/alignment/alignment_config.h"
#include "sgs/geometry/se3.h"

namespace sgs::alignment {

/// Learns how long the sensor takes to read a picture from top to bottom, and predicts how the
/// camera moves during one readout. The readout time tau is a constant of the sensor (0 = global
/// shutter, negative = bottom row first), so it is the slope of a regression over all frames.
///
/// A picture shows its turn against a keyframe's only, that is tau times the difference of the two
/// turning rates: a camera that turns steadily shows nothing, however fast. By how much the
/// keyframe's own turn differs from tau times its rate is common to all frames aligned to it; it is
/// estimated together with tau (one after the other it would take tau's part for its own), and
/// taken off before one of them becomes the next keyframe. Without that the errors of all keyframes
/// would add up.
class ReadoutEstimator {
 public:
  explicit ReadoutEstimator(const ReadoutConfig& config);

  /// Gaussian belief about the camera twist over one readout, rotation first, rad and m; only the
  /// rotation is uncertain (a hand's jerk shifts the camera by less than a pixel).
  struct Belief {
    Vector6d mean = Vector6d::Zero();
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();  ///< of the rotation, 1/rad^2
  };
  /// For a camera that moves with `velocity` (camera twist per second), as it will appear against
  /// the keyframe of that number.
  Belief predict(const Vector6d& velocity, std::size_t keyframe) const;
  /// A new keyframe, taken for having turned by `rotation` during its readout while the camera
  /// turned at `turning_rate`. One that was never added is taken for standing still.
  void add_keyframe(std::size_t keyframe, const Eigen::Vector3d& turning_rate,
                    const Eigen::Vector3d& rotation);
  /// Takes in the rotation over the readout as one frame's picture alone shows it.
  void update(const Eigen::Vector3d& turning_rate, const Eigen::Vector3d& rotation,
              const Eigen::Matrix3d& information, std::size_t keyframe);
  /// By how much rotations seen against a keyframe are too large.
  Eigen::Vector3d keyframe_error(std::size_t keyframe) const;

  /// Time from the first row to the last, within what sensors do.
  double readout_s() const;

 private:
  struct Keyframe {
    Eigen::Vector3d turning_rate = Eigen::Vector3d::Zero();
    Eigen::Vector3d rotation = Eigen::Vector3d::Zero();  // that it was taken for
    // What its own turn is short of tau times its rate.
    Eigen::Vector3d short_by = Eigen::Vector3d::Zero();
    double variance = 0;  // of that, rad^2
  };
  Keyframe keyframe_or_still(std::size_t keyframe) const;
  /// What is known of tau and of the error of the keyframe that frames are aligned to, together.
  struct Joint {
    Eigen::Matrix4d information = Eigen::Matrix4d::Zero();
    Eigen::Vector4d moment = Eigen::Vector4d::Zero();  // information times estimate
  };
  /// Frames are aligned to another keyframe from now on.
  void begin(std::size_t keyframe);

  ReadoutConfig config_;
  double information_;  // of the readout time, 1/s^2
  double moment_ = 0;   // times its estimate
  // How much the turn within a picture scatters about tau times the mean rate since the last one:
  // nearly nothing for a smooth motion, a pixel or two for a shaking hand. From one frame to the
  // next, so that what is wrong with the keyframe does not count.
  double scatter_;  // variance, rad^2
  std::optional<Eigen::Vector3d> last_off_;
  std::vector<Keyframe> keyframes_;
  std::optional<std::size_t> aligned_to_;  // the keyframe of joint_
  Joint joint_;
};

}  // namespace sgs::alignment
