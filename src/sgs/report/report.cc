// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/report/report.h"

#include <fmt/format.h>

#include <string_view>

#include "sgs/io/atomic_file.h"
#include "sgs/report/drawings.h"
#include "sgs/report/html.h"
#include "sgs/report/page.h"
#include "sgs/report/scene.h"

namespace sgs::report {
namespace {

std::string header(const ReportData& data) {
  std::string html = "<h1>" + html_escaped(data.title) + "</h1><p class='sub'>" +
                     html_escaped(data.subtitle) + "</p><div class='tags'>";
  for (const auto& [name, value] : data.facts) {
    html += "<span><b>" + html_escaped(name) + "</b> " + html_escaped(value) + "</span>";
  }
  return html + "</div>";
}

std::string tiles(const std::vector<eval::MetricLine>& lines) {
  std::string html = "<div class='tiles'>";
  for (const std::string_view label :
       {"ATE RMSE", "Tracked", "PSNR (gsicp)", "PSNR (held out)", "FPS (system)", "Gaussians"}) {
    for (const eval::MetricLine& line : lines) {
      if (line.label != label) continue;
      html += "<div class='tile'><b>" + html_escaped(line.value) + "</b><span>" +
              html_escaped(line.label) + "</span></div>";
    }
  }
  return html + "</div>\n";
}

std::string score_section(const ReportData& data, const std::vector<eval::MetricLine>& lines) {
  std::string html = "<div class='groups'>", group;
  for (const eval::MetricLine& line : lines) {
    if (line.group != group) {
      html += (group.empty() ? "" : "</table></div>") + ("<div><h3>" + html_escaped(line.group)) +
              "</h3><table>";
      group = line.group;
    }
    html += "<tr><td>" + html_escaped(line.label) + "</td><td class='v'>" +
            html_escaped(line.value) + "</td></tr>";
  }
  html += "</table></div></div>";
  if (!data.notes.empty()) {
    html += "<ul class='notes'>";
    for (const std::string& note : data.notes) html += "<li>" + html_escaped(note) + "</li>";
    html += "</ul>";
  }
  return section_html("Scores", "", html);
}

std::string picture_section(const ReportData& data) {
  std::string html;
  for (const eval::FramePictures& p : data.pictures) html += slider_html(p);
  if (html.empty()) return {};
  return section_html(
      "Rendering against truth",
      "Drag across a picture: left, what the camera saw; right, the map rendered at "
      "the estimated pose. The error is the mean absolute colour difference (black "
      "0, yellow 0.25 and above).",
      "<div class='pair'>" + html + "</div>");
}

std::string map_section(const ReportData& data) {
  const std::vector<Drawing> drawings = map_drawings(data);
  std::vector<Drawing> wide, narrow;
  for (const Drawing& d : drawings) (d.name == "map_growth" ? wide : narrow).push_back(d);
  return section_html("Map", "", figures_html(wide) + figures_html(narrow, true));
}

std::string config_section(const ReportData& data) {
  if (data.config_toml.empty()) return {};
  return "<section><details><summary>Configuration as used</summary><pre>" +
         html_escaped(data.config_toml) + "</pre></details></section>\n";
}

}  // namespace

std::string report_html(const ReportData& data) {
  check_columns(data);
  const Runs runs(&data, 1);
  const std::vector<eval::MetricLine> lines = eval::metric_lines(data.metrics);
  std::string body = header(data) + tiles(lines);
  body += section_html("Trajectory", "",
                       scene_html(runs) + figures_html(trajectory_drawings(runs), true));
  body += section_html("Tracking", "", figures_html(error_drawings(runs)));
  body += section_html("Degeneracy",
                       "What geometry alone could not observe, and where vision filled it in.",
                       figures_html(degeneracy_drawings(data)));
  body += picture_section(data) + map_section(data);
  body += section_html("Timing", "", figures_html(timing_drawings(data)));
  body += score_section(data, lines) + config_section(data);
  return page_html(data.title, body);
}

Status save_report(const std::filesystem::path& path, const ReportData& data) {
  return io::write_file(path, report_html(data));
}

}  // namespace sgs::report
