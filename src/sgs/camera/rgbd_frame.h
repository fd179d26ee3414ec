// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "sgs/camera/pinhole.h"
#include "sgs/core/image.h"
#include "sgs/geometry/se3.h"

namespace sgs {

/// One undistorted, registered RGB-D frame. Colour and depth have the camera's size.
///
/// Undistortion and resampling leave pixels that no part of the sensor saw. Their colour is black
/// or repeated and means nothing: they are not tracked, not learned from and not scored.
struct RgbdFrame {
  std::int64_t index = 0;  ///< position in the sequence, bad frames counted
  double timestamp_s = 0;
  PinholeCamera camera;
  ColorImage color;
  DepthImage depth;  ///< metres, 0 = no measurement
  /// Which pixels the camera saw; null: all of them. Shared by the frames of a lens.
  std::shared_ptr<const PixelMask> seen = {};
  /// Which pixels show nothing that moves by itself, as far as anybody has found out; null: all of
  /// them. Where leave_out_movers() has taken that out (camera/movers.h), it is in `seen` too.
  std::shared_ptr<const PixelMask> still = {};
  double depth_delay_s = 0;                 ///< by how much later than its colour it was measured
  std::optional<SE3> truth_T_world_camera;  ///< ground truth where known; never read by SLAM
  /// Where somebody else says that the camera was; only a tracker of given poses reads it.
  std::optional<SE3> given_T_world_camera = {};

  /// As it was delivered, where its depth or its mask are others since; null: it is that one.
  std::shared_ptr<const RgbdFrame> delivered = {};

  bool sees(int u, int v) const { return !seen || (*seen)(u, v) != 0; }
};

/// A copy to be changed, which knows what it was made of.
inline std::shared_ptr<RgbdFrame> copy_to_change(const std::shared_ptr<const RgbdFrame>& frame) {
  auto out = std::make_shared<RgbdFrame>(*frame);
  if (!out->delivered) out->delivered = frame;
  return out;
}

}  // namespace sgs
