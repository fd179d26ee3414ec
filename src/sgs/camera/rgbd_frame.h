// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "sgs/camera/pinhole.h"
#include "sgs/core/image.h"
#include "sgs/geometry/se3.h"

namespace sgs {

/// One undistorted, registered RGB-D frame. Colour and depth have the camera's size.
struct RgbdFrame {
  std::int64_t index = 0;  ///< position in the sequence, bad frames counted
  double timestamp_s = 0;
  PinholeCamera camera;
  ColorImage color;
  DepthImage depth;                         ///< metres, 0 = no measurement
  double depth_delay_s = 0;                 ///< by how much later than its colour it was measured
  std::optional<SE3> truth_T_world_camera;  ///< ground truth where known; never read by SLAM
  /// Where somebody else says that the camera was; only a tracker of given poses reads it.
  std::optional<SE3> given_T_world_camera = {};
};

}  // namespace sgs
