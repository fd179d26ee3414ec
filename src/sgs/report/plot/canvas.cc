// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/report/plot/canvas.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sgs/core/error.h"
#include "sgs/report/html.h"

namespace sgs::report {
namespace {

constexpr std::string_view kPalette = R"css(
:root{color-scheme:light dark;--bg:#f5f6f8;--card:#fff;--ink:#1b2430;--soft:#566171;--line:#e1e5ea;
--accent:#0072b2;--c0:#0072b2;--c1:#d55e00;--c2:#009e73;--c3:#b0608f;--c4:#b98a00;--c5:#5a6472;
--h0:#0d0887;--h1:#47039f;--h2:#7301a8;--h3:#9c179e;--h4:#bd3786;--h5:#d8576b;--h6:#ed7953;
--h7:#f2892f;--h8:#e8a400}
@media (prefers-color-scheme:dark){:root{--bg:#12161c;--card:#1a2029;--ink:#e7ebf0;--soft:#a3aebb;
--line:#2f3844;--accent:#56b4e9;--c0:#56b4e9;--c1:#f0813a;--c2:#2dc49a;--c3:#d98fbe;--c4:#f0d442;
--c5:#aab4c2;--h0:#8f4ed0;--h1:#a848b8;--h2:#bd3f9f;--h3:#cf4a84;--h4:#de6066;--h5:#ec7a50;
--h6:#f6973c;--h7:#fbb92f;--h8:#f5e626}}
)css";

constexpr std::string_view kSvgCss = R"css(
svg text{fill:var(--soft);font-size:11px;font-family:inherit}
svg .label{fill:var(--ink);font-size:12px}
svg .head{fill:var(--ink);font-size:12px;font-weight:600}
.grid{stroke:var(--line);stroke-width:1}
.line{fill:none;stroke:currentColor;stroke-width:1.6;stroke-linejoin:round;stroke-linecap:round}
.line.dashed{stroke-dasharray:5 4}.line.heavy{stroke-width:2.6}
.area{fill:currentColor;fill-opacity:.3;stroke:currentColor;stroke-width:1}
.stack{fill:currentColor;fill-opacity:.8;stroke:none}
.bar{fill:currentColor}
.paper{fill:var(--card)}.row{fill:var(--line);fill-opacity:.45}
.line.band{stroke-width:6;stroke-opacity:.35}
.threshold{stroke:var(--c1);stroke-width:1.3;stroke-dasharray:6 4}
svg .threshold-name{fill:var(--c1);paint-order:stroke;stroke:var(--card);stroke-width:3px}
.c0{color:var(--c0)}.c1{color:var(--c1)}.c2{color:var(--c2)}.c3{color:var(--c3)}.c4{color:var(--c4)}
.c5{color:var(--c5)}
.h0{color:var(--h0)}.h1{color:var(--h1)}.h2{color:var(--h2)}.h3{color:var(--h3)}.h4{color:var(--h4)}
.h5{color:var(--h5)}.h6{color:var(--h6)}.h7{color:var(--h7)}.h8{color:var(--h8)}
.st-ok{color:var(--c2)}.st-degenerate{color:var(--c4)}.st-lost{color:var(--c1)}.st-bad{color:var(--c5)}
.st-on{color:var(--c0)}.st-off{color:var(--line)}
)css";

std::string_view anchor_name(TextAnchor anchor) {
  return anchor == TextAnchor::kStart ? "start" : anchor == TextAnchor::kMiddle ? "middle" : "end";
}

/// Width of a text at the legend's size, roughly: nobody measures fonts here.
double text_width(std::string_view text) {
  const auto glyphs =
      std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; });
  return 6.0 * static_cast<double>(glyphs);
}

}  // namespace

std::string svg_open(double width, double height, std::string_view title,
                     std::string_view attributes) {
  return fmt::format(
      "<svg viewBox='0 0 {:g} {:g}' role='img' aria-label='{}'{}{}><title>{}</title>", width,
      height, html_escaped(title), attributes.empty() ? "" : " ", attributes, html_escaped(title));
}

std::string svg_text(double u, double v, std::string_view text, TextAnchor anchor,
                     std::string_view css_class) {
  return fmt::format(
      "<text x='{:.1f}' y='{:.1f}' text-anchor='{}'{}>{}</text>", u, v, anchor_name(anchor),
      css_class.empty() ? "" : fmt::format(" class='{}'", css_class), html_escaped(text));
}

std::string svg_legend(const std::vector<LegendEntry>& entries, double u, double v, double width,
                       double& height) {
  constexpr double kSample = 18, kGap = 6, kSpace = 18, kRow = 17;
  std::string svg;
  double at = u, row = v;
  for (const LegendEntry& entry : entries) {
    const double needed = kSample + kGap + text_width(entry.label) + kSpace;
    if (at > u && at + needed - kSpace > u + width) {
      at = u;
      row += kRow;
    }
    if (entry.block) {
      svg += fmt::format("<rect class='bar {}' x='{:.1f}' y='{:.1f}' width='12' height='10'/>",
                         entry.css_class, at + 3, row - 9);
    } else {
      svg += fmt::format("<path class='line {}' d='M{:.1f} {:.1f}h{}'/>", entry.css_class, at,
                         row - 4, kSample);
    }
    svg += svg_text(at + kSample + kGap, row, entry.label, TextAnchor::kStart);
    at += needed;
  }
  if (!entries.empty()) height += row - v + kRow;
  return svg;
}

int heat_step(double share) {
  return std::clamp(static_cast<int>(share * kHeatSteps), 0, kHeatSteps - 1);
}

std::string_view palette_css() { return kPalette; }
std::string_view svg_css() { return kSvgCss; }

std::string standalone_svg(const Drawing& drawing) {
  SGS_CHECK(drawing.svg.starts_with("<svg "), "an empty drawing has no file");
  const std::size_t head_end = drawing.svg.find('>') + 1;
  std::string file = "<svg xmlns='http://www.w3.org/2000/svg' font-family='system-ui,sans-serif' ";
  file += drawing.svg.substr(5, head_end - 5);
  file += "<style>";
  // Custom properties live on :root, which is the svg element here.
  file += palette_css();
  file += svg_css();
  file += "</style><rect class='paper' width='100%' height='100%'/>";
  return file + drawing.svg.substr(head_end) + "\n";
}

}  // namespace sgs::report
