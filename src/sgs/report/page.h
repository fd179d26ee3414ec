// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sgs/report/plot/canvas.h"
#include "sgs/report/report_data.h"

namespace sgs::report {

/// A titled box of the page; "" without content. `title` and `lead` are HTML.
std::string section_html(std::string_view title, std::string_view lead, std::string_view content);

/// One drawing as a numbered figure; "" when it is empty.
std::string figure_html(const Drawing& drawing);
/// Drawings below each other, or two side by side where the page is wide enough.
std::string figures_html(const std::vector<Drawing>& drawings, bool side_by_side = false);

/// Truth against rendering with a slider between them, the error on request.
std::string slider_html(const eval::FramePictures& pictures);
/// The map before and after it was refined; empty where it was not.
std::string before_after_html(const eval::FramePictures& pictures);

/// A document from its start to the end of its head: title, `style` after the palette, and a
/// content security policy that lets nothing in from outside.
std::string page_head(std::string_view title, std::string_view style);

/// The whole document around `body`: head, style, script.
std::string page_html(std::string_view title, std::string_view body);

}  // namespace sgs::report
