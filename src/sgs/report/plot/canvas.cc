// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/report/plot/canvas.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "sgs/core/error.h"
#include "sgs/report/html.h"
#include "sgs/report/page_files.h"

namespace sgs::report {
namespace {

std::string_view anchor_name(TextAnchor anchor) {
  return anchor == TextAnchor::kStart ? "start" : anchor == TextAnchor::kMiddle ? "middle" : "end";
}

/// The style of a drawing's file: the palette's light values put in, because what reads SVG files
/// (Inkscape, librsvg) knows neither custom properties nor media queries.
std::string light_svg_css() {
  std::map<std::string_view, std::string> values;
  const auto resolved = [&](std::string_view css) {
    constexpr std::string_view kOpen = "var(--";
    std::string out;
    for (std::size_t at; (at = css.find(kOpen)) != std::string_view::npos;) {
      const std::size_t end = css.find(')', at);
      out += css.substr(0, at);
      out += values.at(css.substr(at + kOpen.size(), end - at - kOpen.size()));
      css.remove_prefix(end + 1);
    }
    return out.append(css);
  };
  // Later declarations win: the palette's light block comes after the dark one.
  std::string_view palette = palette_css();
  for (std::size_t at; (at = palette.find("\n  ")) != std::string_view::npos;) {
    palette.remove_prefix(at + 1);
    const std::string_view line = palette.substr(0, palette.find('\n'));
    const std::size_t name = line.find("--"), colon = line.find(": "), end = line.find(';');
    if (name == line.find_first_not_of(' ') && colon < end && end != std::string_view::npos) {
      values[line.substr(name + 2, colon - name - 2)] =
          resolved(line.substr(colon + 2, end - colon - 2));
    }
  }
  return resolved(svg_css());
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

std::string_view palette_css() { return page_text("palette.css"); }
std::string_view svg_css() { return page_text("svg.css"); }

std::string standalone_svg(const Drawing& drawing) {
  SGS_CHECK(drawing.svg.starts_with("<svg "), "an empty drawing has no file");
  const std::size_t head_end = drawing.svg.find('>') + 1;
  std::string file = "<svg xmlns='http://www.w3.org/2000/svg' font-family='system-ui,sans-serif' ";
  file += drawing.svg.substr(5, head_end - 5);
  file += "<style>";
  file += light_svg_css();
  file += "</style><rect class='paper' width='100%' height='100%'/>";
  return file + drawing.svg.substr(head_end) + "\n";
}

}  // namespace sgs::report
