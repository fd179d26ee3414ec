// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "sgs/camera/register_depth.h"
#include "sgs/camera/rgbd_frame.h"
#include "sgs/camera/undistort.h"

namespace sgs {

/// Brings pairs of images, as two cameras deliver them, into the colour camera without distortion.
/// What that takes for each pixel is made with the first pair, and no sooner: a recording that
/// announces a huge camera and has no such image costs nothing.
class PairRectifier {
 public:
  /// Without a depth camera, depth comes in the pixels of the colour camera. `T_color_depth` maps
  /// points of the depth camera into the colour camera.
  PairRectifier(const LensCamera& color, const std::optional<LensCamera>& depth,
                const SE3& T_color_depth)
      : color_(color), depth_(depth), T_color_depth_(T_color_depth) {}

  const PinholeCamera& color_camera() const { return color_.camera; }
  const PinholeCamera& depth_camera() const { return depth_ ? depth_->camera : color_.camera; }

  /// Sets the images of `frame`; those given have the sizes of their cameras.
  void rectify(ColorImage color, DepthImage depth, RgbdFrame& frame);
  /// A mask of colour's pixels in those of the frames that rectify() makes: each has the value of
  /// the nearest; what the lens does not show is `outside`.
  PixelMask rectify(PixelMask mask, std::uint8_t outside);

 private:
  void prepare();

  LensCamera color_;
  std::optional<LensCamera> depth_;
  SE3 T_color_depth_;
  bool ready_ = false;
  std::optional<Undistorter> undistorter_;
  std::optional<DepthRegistration> registration_;
};

}  // namespace sgs
