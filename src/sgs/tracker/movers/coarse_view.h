// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "sgs/camera/pyramid.h"
#include "sgs/camera/rgbd_frame.h"

namespace sgs::tracker {

/// A frame in a quarter of its size: enough to tell whether surface is where it was.
struct CoarseView {
  static constexpr int kLevel = 2;  ///< of the pyramid, where it has so many

  std::int64_t frame = 0;
  double timestamp_s = 0;
  PinholeCamera camera;
  int step_px = 1;      ///< pixels of the full picture to one of these
  Image<float> gray;    ///< 0..255; NaN where the camera did not see
  DepthImage depth;     ///< metres, one pixel in step_px x step_px; 0 = no measurement

  static CoarseView of(const RgbdFrame& frame, const GrayPyramid& pyramid);
};

}  // namespace sgs::tracker
