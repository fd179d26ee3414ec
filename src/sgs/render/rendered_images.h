// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/core/image.h"
#include "sgs/render/rasterizer.h"

namespace sgs::render {

/// Colours of a rendering in 8 bits, clamped to [0, 1] and rounded.
ColorImage to_color_image(const Image<Rgbf>& color);
/// Mean depth in metres where the rendering is more opaque than `min_alpha`; 0 elsewhere.
DepthImage mean_depth(const Rendering& rendering, float min_alpha);

}  // namespace sgs::render
