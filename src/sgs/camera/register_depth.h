// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sgs/camera/pinhole.h"
#include "sgs/core/image.h"
#include "sgs/geometry/se3.h"

namespace sgs {

/// Brings the depth of one camera into the image of another: each measurement is moved into the
/// colour camera and drawn as the patch that its pixel covers there, so that no holes appear where
/// colour is finer than depth. Of several patches on a pixel the nearest one counts (occlusion).
/// Every value is one measurement: depth is never mixed, so edges stay edges. What the depth camera
/// does not see stays 0.
///
/// Patches of neighbours on one surface share their corners, so slanted surfaces stay closed, too.
/// With equal cameras and the identity the output is the input, bit for bit. Immutable,
/// thread-safe.
class DepthRegistration {
 public:
  /// `depth_camera` delivers the depth images. `color_camera` says how the output is to look: with
  /// its distortion the result fits the pictures as delivered, without it undistorted ones.
  /// `T_color_depth` maps points of the depth camera into the colour camera.
  DepthRegistration(const LensCamera& depth_camera, const LensCamera& color_camera,
                    const SE3& T_color_depth);

  /// Depth along the colour camera's axis, of that camera's size. `depth` has the depth camera's.
  DepthImage operator()(const DepthImage& depth) const;

 private:
  struct Box {
    float left, top, right, bottom;
  };
  Eigen::Vector2f project(const Eigen::Vector3f& direction, float inverse_depth) const;
  void project_joints(const DepthImage& inverse_depth, int row,
                      std::vector<Eigen::Vector2f>& joints) const;
  void draw(const Box& box, float depth, DepthImage& out) const;

  LensCamera color_;
  int width_ = 0, height_ = 0;  ///< of the depth image
  Eigen::Vector3f offset_;      ///< of the depth camera in the colour camera, metres
  std::vector<Eigen::Vector3f>
      corners_;                       ///< (width+1)(height+1) rays at depth 1, turned; NaN = none
  std::vector<float> depth_factors_;  ///< colour depth of a pixel's ray at depth 1
  Eigen::Vector2d field_min_, field_max_;  ///< of what the colour lens sees, undistorted
  float same_surface_ = 0;                 ///< relative difference of inverse depths
  float largest_patch_px_ = 0;
};

}  // namespace sgs
