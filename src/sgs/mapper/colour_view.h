// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/camera/rgbd_frame.h"
#include "sgs/render/rasterizer.h"

namespace sgs::mapper {

/// Gives a grey frame the colours that the map shows from its place: of each pixel the rendered
/// colour, at the brightness that was measured. What the map does not show there counts as
/// not seen. `rendering` has the frame's size.
void colour_view(const render::Rendering& rendering, RgbdFrame& frame);

}  // namespace sgs::mapper
