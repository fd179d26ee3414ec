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
  for (const eval::MetricLine& line : lines) {
    if (line.info.rank != eval::Rank::kTile) continue;
    html += "<div class='tile'><b>" + html_escaped(line.value) + "</b><span>" +
            html_escaped(line.info.label) + "</span></div>";
  }
  return html + "</div>\n";
}

std::string score_section(const ReportData& data, const std::vector<eval::MetricLine>& lines) {
  std::string html = "<div class='groups'>";
  std::string_view group;
  for (const eval::MetricLine& line : lines) {
    if (line.info.group != group) {
      html += (group.empty() ? "" : "</table></div>") +
              ("<div><h3>" + html_escaped(line.info.group)) + "</h3><table>";
      group = line.info.group;
    }
    html += fmt::format("<tr><td title='{}'>{}</td><td class='v'>{}</td></tr>",
                        html_escaped(line.info.meaning), html_escaped(line.info.label),
                        html_escaped(line.value));
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

std::string refinement_section(const ReportData& data) {
  std::string html;
  for (const eval::FramePictures& p : data.pictures) html += before_after_html(p);
  if (html.empty()) return {};
  return section_html("Before and after refinement",
                      "Drag across a picture: left, the map of the run; right, the same map after "
                      "`sgs refine`, from the same frame's pose.",
                      "<div class='pair'>" + html + "</div>");
}

std::string map_section(const ReportData& data) {
  const std::vector<Drawing> drawings = map_drawings(data);
  std::vector<Drawing> wide, narrow;
  for (const Drawing& d : drawings) (d.name == "map_growth" ? wide : narrow).push_back(d);
  return section_html("Map", "", figures_html(wide) + figures_html(narrow, true));
}

/// Where tracking was lost, and why: a row for each stretch of lost frames.
std::string losses_html(const ReportData& data) {
  constexpr std::size_t kMaxRows = 50;
  const Column time = time_s(data);
  std::string rows;
  std::size_t stretches = 0;
  for (std::size_t i = 0; i < data.frames.size(); ++i) {
    const auto lost = [&](std::size_t k) {
      return k < data.frames.size() && !data.frames[k].bad &&
             data.frames[k].status == tracker::TrackingStatus::kLost;
    };
    if (!lost(i)) continue;
    const std::size_t first = i;
    while (lost(i + 1)) ++i;
    if (++stretches > kMaxRows) continue;
    const alignment::LostReason reason = data.frames[first].lost_reason;
    rows += fmt::format(
        "<tr><td class='v'>{}</td><td class='v'>{}</td><td class='v'>{:.2f} s</td>"
        "<td><code>{}</code></td><td>{}</td></tr>",
        data.frames[first].index, data.frames[i].index, time[first], to_string(reason),
        html_escaped(alignment::explain(reason)));
  }
  if (rows.empty()) return {};
  const std::string more =
      stretches > kMaxRows ? fmt::format("<p>... and {} more</p>", stretches - kMaxRows) : "";
  return "<h3>Where tracking was lost</h3><div class='scroll'><table><tr><th>from frame</th>"
         "<th>to frame</th><th>at</th><th>reason of the first</th><th></th></tr>" +
         rows + "</table></div>" + more;
}

std::string value_section(const ReportData& data) {
  const std::string figures = figures_html(value_drawings(data), true);
  if (figures.empty()) return {};
  return "<section><details><summary>Every per-frame value</summary>" + figures +
         "</details></section>\n";
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
  body += section_html("Tracking", "", figures_html(error_drawings(runs)) + losses_html(data));
  body += section_html("Degeneracy",
                       "What geometry alone could not observe, and where vision filled it in.",
                       figures_html(degeneracy_drawings(data)));
  body += section_html("Depth calibration", "", figures_html(calibration_drawings(data), true));
  body += refinement_section(data) + picture_section(data) + map_section(data);
  body += section_html("Timing", "", figures_html(timing_drawings(data)));
  body += score_section(data, lines) + value_section(data) + config_section(data);
  return page_html(data.title, body);
}

Status save_report(const std::filesystem::path& path, const ReportData& data) {
  return io::write_file(path, report_html(data));
}

}  // namespace sgs::report
