// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/core/image.h"
#include "sgs/render/rasterizer.h"

namespace sgs::viewer {

// What the panes show, as 8-bit pictures; pure functions.

/// Every `stride`-th pixel in both directions (means of the stride x stride blocks).
ColorImage shrink(const ColorImage& image, int stride);
/// Every `stride`-th pixel.
PixelMask shrink(const PixelMask& mask, int stride);
/// Paints what the camera did not see as the page's own grey; an empty mask: it saw all.
void veil(ColorImage& image, const PixelMask& seen);
/// Draws a line, two pixels wide, inside the border of what is 0 in `still`: what moves. A mask of
/// the picture's size.
void outline(ColorImage& image, const PixelMask& still);
/// Every `stride`-th pixel; depths are not averaged across edges.
DepthImage shrink(const DepthImage& image, int stride);

/// Near is yellow, far is dark blue, on a logarithmic scale from 0.3 to 10 m; black without
/// measurement. (Linear blend of five colours of rising lightness: readable when colour-blind.)
ColorImage depth_picture(const DepthImage& depth);
/// Clamped to 0..1.
ColorImage color_picture(const Image<render::Rgbf>& color);
/// Mean absolute difference of the channels, black 0 to yellow >= 0.25. Where the map is empty the
/// rendering is black, and that counts like any other error.
ColorImage error_picture(const ColorImage& measured, const ColorImage& rendered);

}  // namespace sgs::viewer
