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

/// Copies of a caller's images, checked by check_views().
ColorImage copy_color(const ColorView& view);
/// In metres; what is no measurement is 0.
DepthImage copy_depth(const DepthView& view);

}  // namespace sgs::api::internal
