// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sgs/camera/depth_calibration.h"
#include "sgs/geometry/se3.h"

namespace sgs {

/// What a new calibration makes of depth that an older one has corrected: for what was kept of
/// frames that are gone. To first order in the distance between the two shifts.
class DepthChange {
 public:
  /// Both of the same camera and, where they have offsets, the same grid; `before` may be empty
  /// (nothing was corrected).
  DepthChange(const DepthCalibration& before, const DepthCalibration& after);

  /// The new calibration.
  const DepthCalibration& after() const { return after_; }
  /// A depth image corrected by `before` as `after` would have corrected it.
  DepthImage apply(const DepthImage& before) const { return difference_.apply(before); }
  /// A point in its camera's coordinates on a surface with that unit normal: where and how the
  /// surface lies now. `lag`: of the camera that saw it, its twist over
  /// the time by which depth is measured later than the point says.
  void apply(Eigen::Vector3f& point, Eigen::Vector3f& normal,
             const Vector6d& lag = Vector6d::Zero()) const;
  /// The same of a point that stays on its ray, on a surface whose inverse depth changes by `slope`
  /// per pixel of the image.
  void apply(Eigen::Vector3f& point, const Eigen::Vector2f& slope,
             const Vector6d& lag = Vector6d::Zero()) const;
  /// Root mean square over the image of the change of inverse depth, 1/m, the changes of shift and
  /// delay.
  double rms_per_m() const;
  double shift_px() const { return difference_.shift_px.norm(); }
  double delay_s() const { return difference_.delay_s; }

 private:
  /// What is added to inverse depth at a pixel, and its slope per pixel.
  struct Offset {
    float per_m = 0;
    Eigen::Vector2f slope = Eigen::Vector2f::Zero();
  };
  /// On the ray (x, y, 1) of the colour camera.
  Offset offset_on(const Eigen::Vector3f& ray) const;
  /// The camera and the offsets as apply() reads them, many thousand times in a row.
  void prepare();

  DepthCalibration after_, difference_;
  float fx_ = 1, fy_ = 1, cx_ = 0, cy_ = 0;
  Eigen::Vector2f shift_ = Eigen::Vector2f::Zero();
  Eigen::Vector2f nodes_per_px_ = Eigen::Vector2f::Zero();
  std::vector<float> offsets_;  ///< the grid, one row and column repeated at its end
};

}  // namespace sgs
