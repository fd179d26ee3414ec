// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/api/session.h"
#include "sgs/camera/pinhole.h"
#include "sgs/camera/rgbd_frame.h"
#include "sgs/core/error.h"

namespace sgs::api::internal {

/// Refuses images that are not there, not of the camera's size, or whose rows overlap.
Status check_views(const ColorView& color, const DepthView& depth, const PinholeCamera& camera);

/// Copies a caller's image, checked by check_views(), into one whose memory is used again where it
/// has the size.
void copy_color(const ColorView& view, ColorImage& color);

/// The same of depth, in metres; what is no measurement is 0. Keeps what raw units are in metres.
class DepthCopier {
 public:
  void copy(const DepthView& view, DepthImage& depth);

 private:
  DepthImage metres_;  // of each raw value, with `scale_`
  double scale_ = 0;
};

}  // namespace sgs::api::internal
