// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/core/image.h"

namespace sgs {

/// A rectangle of pixels.
struct PixelArea {
  int x = 0, y = 0, width = 0, height = 0;
};

/// The largest rectangle in which every pixel was seen: pictures are cut to it before they are
/// shown. Empty where nothing was seen.
PixelArea largest_seen_area(const PixelMask& seen);

/// Share of the pixels that were seen.
double seen_share(const PixelMask& seen);

/// The part of a picture within `area`, which lies inside it.
ColorImage cropped(const ColorImage& picture, const PixelArea& area);

}  // namespace sgs
