// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/eval/report.h"

#include <string_view>

#include "sgs/eval/html.h"
#include "sgs/eval/report_plots.h"
#include "sgs/io/atomic_file.h"

namespace sgs::eval {
namespace {

/// Palette of Okabe and Ito (2008), lighter or darker where the background asks for it.
constexpr std::string_view kStyle = R"css(
:root{--bg:#f6f7f9;--card:#fff;--ink:#1b2430;--soft:#5b6675;--line:#dfe4ea;--accent:#0072b2;
--c0:#0072b2;--c1:#d55e00;--c2:#009e73;--c3:#b0608f;--c4:#b98a00;--c5:#4a5361}
@media (prefers-color-scheme:dark){:root{--bg:#12161c;--card:#1a2029;--ink:#e7ebf0;--soft:#9aa6b5;
--line:#2c3541;--accent:#56b4e9;--c0:#56b4e9;--c1:#f0813a;--c2:#2dc49a;--c3:#d98fbe;--c4:#f0d442;
--c5:#aab4c2}}
*{box-sizing:border-box}
body{margin:0;background:var(--bg);color:var(--ink);font:15px/1.5 system-ui,-apple-system,"Segoe UI",
Roboto,"Helvetica Neue",sans-serif}
main{max-width:1080px;margin:0 auto;padding:28px 18px 60px}
h1{font-size:1.7rem;margin:0;letter-spacing:-.01em;overflow-wrap:anywhere}
h2{font-size:1.1rem;margin:0 0 10px}
h3{font-size:.8rem;margin:0 0 4px;color:var(--soft);text-transform:uppercase;letter-spacing:.05em}
.sub,.lead,.notes{color:var(--soft);margin:4px 0 12px;overflow-wrap:anywhere}
.notes{font-size:.85rem;padding-left:18px}
.tags span{display:inline-block;border:1px solid var(--line);background:var(--card);border-radius:99px;
padding:2px 11px;margin:0 6px 6px 0;font-size:.85rem;overflow-wrap:anywhere}
.tags b{color:var(--soft);font-weight:500}
.tiles{display:grid;grid-template-columns:repeat(auto-fit,minmax(150px,1fr));gap:12px;margin:18px 0}
.tile,section{background:var(--card);border:1px solid var(--line);border-radius:12px}
.tile{padding:12px 16px}.tile b{display:block;font-size:1.45rem;font-weight:650}
.tile span{color:var(--soft);font-size:.85rem}
section{padding:18px;margin:16px 0}
.groups{display:grid;grid-template-columns:repeat(auto-fit,minmax(270px,1fr));gap:18px 30px}
table{border-collapse:collapse;width:100%;font-size:.9rem}
td,th{padding:3px 0;border-bottom:1px solid var(--line);text-align:left;font-weight:400}
td.v,th.v{text-align:right;font-variant-numeric:tabular-nums;white-space:nowrap;padding-left:14px}
.scroll{overflow-x:auto}
.pair{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,400px),1fr));gap:14px 22px}
figure{margin:0 0 12px;min-width:0}figcaption{font-size:.88rem;color:var(--soft);margin-bottom:4px}
svg{display:block;width:100%;height:auto}
svg text{fill:var(--soft);font-size:11px;font-family:inherit}svg .label{fill:var(--ink);font-size:12px}
.grid{stroke:var(--line);stroke-width:1}
.line{fill:none;stroke:currentColor;stroke-width:1.7;stroke-linejoin:round;stroke-linecap:round}
.area{fill:currentColor;fill-opacity:.35;stroke:currentColor;stroke-width:1}
.line.dashed{stroke-dasharray:5 4}
.threshold{stroke:var(--c1);stroke-width:1.3;stroke-dasharray:6 4}
.c0{color:var(--c0)}.c1{color:var(--c1)}.c2{color:var(--c2)}.c3{color:var(--c3)}.c4{color:var(--c4)}
.c5{color:var(--c5)}
.legend{display:flex;flex-wrap:wrap;gap:2px 16px;font-size:.82rem;color:var(--soft);padding-left:52px}
.legend i{display:inline-block;width:18px;height:0;border-top:3px solid currentColor;
margin-right:6px;vertical-align:middle}.legend i.dashed{border-top-style:dashed}
.st-ok{fill:var(--c2);color:var(--c2)}.st-degenerate{fill:var(--c4);color:var(--c4)}
.st-lost{fill:var(--c1);color:var(--c1)}.st-bad{fill:var(--c5);color:var(--c5)}
.st-on{fill:var(--c0);color:var(--c0)}.st-off{fill:var(--line);color:var(--line)}
.frame{display:grid;grid-template-columns:repeat(3,1fr);gap:8px;margin-bottom:14px}
.frame p{grid-column:1/-1;margin:0;font-size:.88rem;color:var(--soft)}
.frame img{width:100%;display:block;border-radius:6px}
@media (max-width:560px){.frame{grid-template-columns:1fr}}
details summary{cursor:pointer;font-weight:600}
pre{overflow-x:auto;font:12.5px/1.45 ui-monospace,Menlo,Consolas,monospace;margin:12px 0 0}
)css";

std::string header(const ReportData& data) {
  std::string html = "<h1>" + html_escaped(data.title) + "</h1><p class='sub'>" +
                     html_escaped(data.subtitle) + "</p><div class='tags'>";
  for (const auto& [name, value] : data.facts) {
    html += "<span><b>" + html_escaped(name) + "</b> " + html_escaped(value) + "</span>";
  }
  return html + "</div>";
}

std::string tiles(const std::vector<MetricLine>& lines) {
  std::string html = "<div class='tiles'>";
  for (const std::string_view label :
       {"ATE RMSE", "Tracked", "PSNR (gsicp)", "PSNR (full)", "FPS (system)", "Gaussians"}) {
    for (const MetricLine& line : lines) {
      if (line.label != label) continue;
      html += "<div class='tile'><b>" + html_escaped(line.value) + "</b><span>" +
              html_escaped(line.label) + "</span></div>";
    }
  }
  return html + "</div>\n";
}

std::string score_section(const ReportData& data, const std::vector<MetricLine>& lines) {
  std::string html = "<div class='groups'>", group;
  for (const MetricLine& line : lines) {
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

std::string comparison_section(const ReportData& data) {
  if (data.others.empty()) return {};
  std::vector<std::vector<MetricLine>> columns = {metric_lines(data.metrics)};
  std::string html =
      "<div class='scroll'><table><tr><th></th><th class='v'>" + html_escaped(data.title) + "</th>";
  for (const auto& [name, metrics] : data.others) {
    columns.push_back(metric_lines(metrics));
    html += "<th class='v'>" + html_escaped(name) + "</th>";
  }
  html += "</tr>";
  for (std::size_t i = 0; i < columns[0].size(); ++i) {
    html += "<tr><td>" + html_escaped(columns[0][i].label) + "</td>";
    for (const auto& column : columns) {
      html += "<td class='v'>" + html_escaped(column[i].value) + "</td>";
    }
    html += "</tr>";
  }
  return section_html("Comparison", "", html + "</table></div>");
}

std::string picture_section(const ReportData& data) {
  std::string html;
  for (const FramePictures& p : data.pictures) {
    html += fmt::format("<div class='frame'><p>Frame {}{} · {:.2f} dB</p>", p.index,
                        p.heldout ? " (held out)" : "", p.psnr_full_db);
    const std::pair<const char*, const ColorImage*> views[] = {
        {"camera", &p.truth}, {"rendering", &p.rendering}, {"error", &p.error}};
    for (const auto& [name, image] : views) {
      html += fmt::format("<img loading='lazy' alt='{} of frame {}' src='{}'>", name, p.index,
                          jpeg_data_uri(*image));
    }
    html += "</div>\n";
  }
  return section_html("Pictures",
                      "What the camera saw, the map rendered at the estimated pose, and the mean "
                      "absolute colour error (black 0, yellow 0.25 and above).",
                      html);
}

std::string config_section(const ReportData& data) {
  if (data.config_toml.empty()) return {};
  return "<section><details><summary>Configuration</summary><pre>" +
         html_escaped(data.config_toml) + "</pre></details></section>\n";
}

void check_columns(const ReportData& data) {
  const auto check = [&](const Column& column) {
    SGS_CHECK(column.empty() || column.size() == data.time_s.size(),
              "a column of the report is not as long as its time");
  };
  for (const Column* column :
       {&data.error_m, &data.status, &data.track_ms, &data.iterations, &data.gaussians, &data.fps,
        &data.prior_active, &data.condition_number, &data.planarity}) {
    check(*column);
  }
  for (const Column& column : data.weights) check(column);
}

}  // namespace

std::string report_html(const ReportData& data) {
  check_columns(data);
  const std::vector<MetricLine> lines = metric_lines(data.metrics);
  std::string html =
      "<!DOCTYPE html>\n<html lang='en'><head><meta charset='utf-8'><meta name='viewport' "
      "content='width=device-width,initial-scale=1'><meta name='color-scheme' content='light dark'>"
      "<link rel='icon' href='data:,'><title>" +
      html_escaped(data.title) + " · Spectral GS-SLAM</title><style>";
  html += kStyle;
  html += "</style></head><body><main>";
  html += header(data) + tiles(lines);
  html += trajectory_section(data) + tracking_section(data) + degeneracy_section(data);
  html += picture_section(data) + timing_section(data);
  html += score_section(data, lines) + comparison_section(data) + config_section(data);
  return html + "</main></body></html>\n";
}

Status save_report(const std::filesystem::path& path, const ReportData& data) {
  return io::write_file(path, report_html(data));
}

}  // namespace sgs::eval
