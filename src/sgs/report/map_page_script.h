// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace sgs::report {

/// JavaScript of the map page (map_page.h): decodes the .splat records, sorts them back to front
/// when the view changes and draws them with WebGL 2. The projection is that of
/// render::Rasterizer: EWA with a 0.3 px^2 low-pass, alpha up to 0.99, below 1/255 nothing.
/// `#view=N` in the address opens view N, `#bare` hides the controls.
std::string_view map_page_script();

}  // namespace sgs::report
