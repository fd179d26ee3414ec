// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "sgs/camera/pinhole.h"
#include "sgs/camera/rgbd_frame.h"
#include "sgs/core/image.h"

namespace sgs {

/// The camera that sees the same view in `width` x `height` pixels.
PinholeCamera scaled_to(const PinholeCamera& camera, int width, int height);

/// The same camera with at most `max_width` columns (0 = no limit). It is reduced by a whole number
/// where that leaves three quarters of `max_width` or more, which keeps pixels square to each
/// other; otherwise to exactly `max_width`.
PinholeCamera limited_to_width(const PinholeCamera& camera, int max_width);

/// What the camera `to` would have seen of a picture that `from` took, both at one place: area
/// means where it gets smaller, bilinear where it does not; what `from` did not see repeats its
/// border. Equal cameras give the picture itself.
ColorImage resample_color(const ColorImage& image, const PinholeCamera& from,
                          const PinholeCamera& to);

/// Which pixels of `to` `from` saw; null where that is all of them.
std::shared_ptr<const PixelMask> seen_by(const PinholeCamera& from, const PinholeCamera& to);

/// The same for depth: each pixel takes the nearest measurement, nothing is mixed, so that edges
/// stay edges; 0 where `from` saw nothing.
DepthImage resample_depth(const DepthImage& image, const PinholeCamera& from,
                          const PinholeCamera& to);

/// The frame as `to` would have seen it.
RgbdFrame resampled(RgbdFrame frame, const PinholeCamera& to);

}  // namespace sgs
