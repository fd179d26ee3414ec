// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/report/page.h"

#include <fmt/format.h>

#include "sgs/report/html.h"
#include "sgs/report/page_files.h"

namespace sgs::report {
namespace {

constexpr std::string_view kPolicy =
    "default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'";

}  // namespace

std::string section_html(std::string_view title, std::string_view lead, std::string_view content) {
  if (content.empty()) return {};
  return fmt::format("<section><h2>{}</h2>{}{}</section>\n", title,
                     lead.empty() ? "" : fmt::format("<p class='lead'>{}</p>", lead), content);
}

std::string figure_html(const Drawing& drawing) {
  if (drawing.empty()) return {};
  return fmt::format("<figure id='{}'>{}<figcaption>{}</figcaption></figure>\n", drawing.name,
                     drawing.svg, drawing.caption);
}

std::string figures_html(const std::vector<Drawing>& drawings, bool side_by_side) {
  std::string html;
  for (const Drawing& drawing : drawings) html += figure_html(drawing);
  return side_by_side && !html.empty() ? "<div class='pair'>" + html + "</div>" : html;
}

std::string slider_html(const eval::FramePictures& p) {
  return fmt::format(
      "<div class='shot'><div class='slide'><img alt='camera, frame {0}' "
      "src='{1}'><div class='over'><img alt='rendering, frame {0}' src='{2}'></div>"
      "<div class='bar-line'></div><span class='tip l'>camera</span><span class='tip r'>rendering"
      "</span><input type='range' min='0' max='100' value='50' aria-label='camera to the left, "
      "rendering to the right, frame {0}'><img class='err' alt='error, frame {0}' "
      "src='{3}'></div><label><input type='checkbox'> error</label><p class='sub'>Frame {0}{4} · "
      "{5:.2f} dB</p></div>\n",
      p.index, jpeg_data_uri(p.truth), jpeg_data_uri(p.rendering), jpeg_data_uri(p.error),
      p.heldout ? " (held out)" : "", p.psnr_full_db);
}

std::string before_after_html(const eval::FramePictures& p) {
  if (p.before.empty()) return {};
  return fmt::format(
      "<div class='shot'><div class='slide'><img alt='before refinement, frame {0}' "
      "src='{1}'><div class='over'><img alt='after refinement, frame {0}' src='{2}'></div>"
      "<div class='bar-line'></div><span class='tip l'>before</span><span class='tip r'>after"
      "</span><input type='range' min='0' max='100' value='50' aria-label='before refinement to "
      "the left, after it to the right, frame {0}'></div><p class='sub'>Frame {0}{3}</p></div>\n",
      p.index, jpeg_data_uri(p.before), jpeg_data_uri(p.rendering), p.heldout ? " (held out)" : "");
}

std::string page_head(std::string_view title, std::string_view style) {
  std::string html =
      "<!DOCTYPE html>\n<html lang='en'><head><meta charset='utf-8'><meta name='viewport' "
      "content='width=device-width,initial-scale=1'><meta http-equiv='Content-Security-Policy' "
      "content=\"";
  html += kPolicy;
  html += "\"><link rel='icon' href='data:,'><title>" + html_escaped(title) +
          " · Spectral GS-SLAM</title><style>";
  html += palette_css();
  html += style;
  return html + "</style></head>";
}

std::string page_html(std::string_view title, std::string_view body) {
  std::string html =
      page_head(title, std::string(svg_css()) + std::string(page_text("report.css")));
  html += "<body><main>";
  html += body;
  html += "</main>";
  // A page without anything to move needs no script.
  if (body.find("<svg") != std::string_view::npos ||
      body.find("class='slide'") != std::string_view::npos) {
    html += script_html(
        {"vec.mjs", "moment.mjs", "orbit_camera.mjs", "surface.mjs", "scene.mjs", "report.mjs"});
  }
  return html + "</body></html>\n";
}

}  // namespace sgs::report
