// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace sgs::report {

/// JavaScript that draws the map of the report's 3-D view (report_scene.h): Gaussians flattened to
/// discs, the nearest blended, on the CPU, so that it works where the browser has no WebGL (surface
/// splatting, Zwicker et al. 2001).
std::string_view report_surface_script();

}  // namespace sgs::report
