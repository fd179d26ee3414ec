// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>

#include "sgs/camera/rgbd_frame.h"
#include "sgs/registration/rolling_shutter.h"

namespace sgs::alignment {

/// Depth of a frame, 160 pixels wide or a little more: enough to tell whether surface is where it
/// was.
struct CoarseDepth {
  CoarseDepth() = default;
  explicit CoarseDepth(const RgbdFrame& taken);

  int step_px = 1;         ///< one pixel is kept of so many, across and down
  std::int64_t frame = 0;  ///< its index
  double timestamp_s = 0;
  PinholeCamera camera;  ///< of the kept pixels
  DepthImage depth;      ///< metres, 0 = no measurement
  /// How the camera moved while it was measured.
  registration::FrameMotion motion;

  /// Place of a row of `depth` in the readout; rows beyond it count as the first or last.
  float offset(float row) const {
    return std::clamp(registration::ReadoutMotion::offset(row, depth.height()), -0.5f, 0.5f);
  }
};

/// From the camera of now's depth to that of then's, given the same of their pictures: depth is
/// measured somewhat later than colour, whose pose is known.
SE3 between_depths(const CoarseDepth& now, const CoarseDepth& then, const SE3& T_then_now);

}  // namespace sgs::alignment
