// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace sgs::report {

/// Steps of the sequential colour scale: CSS classes h0 (low) .. h8 (high).
inline constexpr int kHeatSteps = 9;

/// A finished drawing: a name for files, a caption for readers, one <svg> element. The colours are
/// CSS classes, so that one drawing serves light and dark pages; see svg_css().
struct Drawing {
  std::string name;     ///< file name without extension
  std::string caption;  ///< HTML
  std::string svg;      ///< "" when there was nothing to draw

  bool empty() const { return svg.empty(); }
};

/// Opening tag with a title for screen readers; `attributes` are added verbatim.
std::string svg_open(double width, double height, std::string_view title,
                     std::string_view attributes = "");

/// Position of a text relative to its anchor point.
enum class TextAnchor { kStart, kMiddle, kEnd };
/// One line of text; `text` is escaped here.
std::string svg_text(double u, double v, std::string_view text, TextAnchor anchor,
                     std::string_view css_class = "");

/// An entry of a legend inside a drawing.
struct LegendEntry {
  std::string label;
  std::string css_class;  ///< colour; dashed, heavy or band for lines
  bool block = false;     ///< a filled square instead of a line
};
/// Entries from left to right, wrapped at `width`; `height` grows by what was used.
std::string svg_legend(const std::vector<LegendEntry>& entries, double u, double v, double width,
                       double& height);

/// Index of the colour step of `share` (0..1, clamped); share must be finite.
int heat_step(double share);

/// CSS of the palette (web/src/palette.css: custom properties for light and dark) and of the
/// classes the drawings use.
std::string_view palette_css();
std::string_view svg_css();

/// The drawing as a file of its own: light colours and a background inside.
std::string standalone_svg(const Drawing& drawing);

}  // namespace sgs::report
