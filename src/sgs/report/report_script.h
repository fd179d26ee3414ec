// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace sgs::report {

/// JavaScript of the report page: picture sliders, a time cursor through all plots over time, and
/// the 3-D view (report_scene.h); goes after report_surface_script(). The page is readable without
/// it.
std::string_view report_script();

}  // namespace sgs::report
