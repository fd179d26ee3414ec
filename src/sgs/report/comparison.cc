// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/report/comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <span>
#include <string_view>

#include "sgs/io/atomic_file.h"
#include "sgs/io/text.h"
#include "sgs/report/html.h"
#include "sgs/report/page.h"
#include "sgs/report/scene.h"

namespace sgs::report {
namespace {

/// Whether less (-1) or more (+1) of a metric is better; 0: neither.
int better_direction(std::string_view label) {
  constexpr std::array<std::string_view, 8> kLess = {
      "ATE",  "RPE",        "LPIPS", "Depth L1", "Tracking", "Mapping iteration, median",
      "Peak", "Frames lost"};
  constexpr std::array<std::string_view, 4> kMore = {"Tracked", "PSNR", "SSIM", "FPS"};
  const auto starts = [&](std::string_view word) { return label.starts_with(word); };
  if (std::any_of(kLess.begin(), kLess.end(), starts)) return -1;
  return std::any_of(kMore.begin(), kMore.end(), starts) ? 1 : 0;
}

std::string key_html(std::size_t run) {
  return fmt::format("<span class='key c{}'></span>", run % 6);
}

/// Rows of all metrics (labels empty) or of some.
std::string table_html(Runs runs, std::span<const std::string_view> labels) {
  std::vector<eval::Metrics> metrics;
  std::vector<std::vector<eval::MetricLine>> columns;
  std::string html = "<div class='scroll'><table><tr><th></th>";
  for (std::size_t i = 0; i < runs.size(); ++i) {
    metrics.push_back(runs[i].metrics);
    columns.push_back(eval::metric_lines(runs[i].metrics));
    html += "<th class='v'>" + key_html(i) + html_escaped(run_name(runs[i])) + "</th>";
  }
  html += "</tr>";
  std::string group;
  for (std::size_t line = 0; line < columns[0].size(); ++line) {
    const eval::MetricLine& first = columns[0][line];
    if (!labels.empty() && std::find(labels.begin(), labels.end(), first.label) == labels.end()) {
      continue;
    }
    if (labels.empty() && first.group != group) {
      group = first.group;
      html += fmt::format("<tr class='group'><td colspan='{}'><h3>{}</h3></td></tr>",
                          runs.size() + 1, html_escaped(group));
    }
    const auto best = best_runs(first.label, metrics);
    html += "<tr><td>" + html_escaped(first.label) + "</td>";
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const bool marked = std::find(best.begin(), best.end(), i) != best.end();
      html += fmt::format("<td class='v{}'>{}</td>", marked ? " best" : "",
                          html_escaped(columns[i][line].value));
    }
    html += "</tr>";
  }
  return html + "</table></div>";
}

std::string table_section(Runs runs) {
  constexpr std::array<std::string_view, 12> kMain = {
      "ATE RMSE",     "ATE max",      "Tracked",          "Degenerate",
      "Prior active", "PSNR (gsicp)", "PSNR (held out)",  "LPIPS (gsicp)",
      "Depth L1",     "FPS (system)", "Tracking, median", "Gaussians"};
  return section_html("Scores side by side", "★ marks the best value.",
                      table_html(runs, kMain) + "<details><summary>All scores</summary>" +
                          table_html(runs, {}) + "</details>");
}

std::string unseen_figure(Runs runs) {
  PlotFigure figure;
  figure.title = "Weight of vision on the least seen axis, by run";
  figure.x_label = "time [s]";
  PlotPanel panel;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (has_data(runs[i].weights[0])) {
      panel.rows.push_back({fmt::format("run {}", i + 1), runs[i].time_s, runs[i].weights[0], {}});
    }
  }
  figure.panels = {panel};
  return figure_html(
      {"unseen",
       "How unseen the least seen axis was (blank: geometry saw every axis; blue: one "
       "was left to vision, where the tracker uses it).",
       figure_svg(figure)});
}

/// Renderings of frames that every run kept, one row per frame.
std::string picture_section(Runs runs) {
  constexpr std::size_t kMaxFrames = 3;
  std::string html;
  std::size_t frames = 0;
  for (const eval::FramePictures& first : runs[0].pictures) {
    std::vector<const eval::FramePictures*> row;
    for (const ReportData& run : runs) {
      const auto same = std::find_if(run.pictures.begin(), run.pictures.end(),
                                     [&](const auto& p) { return p.index == first.index; });
      if (same != run.pictures.end()) row.push_back(&*same);
    }
    if (row.size() != runs.size() || frames++ >= kMaxFrames) continue;
    html += fmt::format("<h3>Frame {}</h3><div class='pair'>", first.index);
    for (std::size_t i = 0; i < row.size(); ++i) {
      html +=
          "<div>" + key_html(i) + html_escaped(run_name(runs[i])) + slider_html(*row[i]) + "</div>";
    }
    html += "</div>";
  }
  return section_html("Rendering against truth",
                      "Drag across a picture: left, what the camera saw; right, the run's map "
                      "rendered at its estimated pose.",
                      html);
}

std::string config_section(Runs runs) {
  std::vector<std::string> configs;
  for (const ReportData& run : runs) configs.push_back(run.config_toml);
  const auto differences = config_differences(configs);
  if (differences.empty()) return {};
  std::string html = "<div class='scroll'><table><tr><th>key</th>";
  for (std::size_t i = 0; i < runs.size(); ++i) {
    html += "<th class='v'>" + key_html(i) + html_escaped(run_name(runs[i])) + "</th>";
  }
  html += "</tr>";
  for (const ConfigDifference& d : differences) {
    html += "<tr><td><code>" + html_escaped(d.key) + "</code></td>";
    for (const std::string& value : d.values) {
      html += "<td class='v'><code>" + html_escaped(value) + "</code></td>";
    }
    html += "</tr>";
  }
  return section_html("Where the configurations differ", "", html + "</table></div>");
}

std::string notes_html(Runs runs) {
  std::string html;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    for (const std::string& note : runs[i].notes) {
      html += "<li>" + html_escaped(run_name(runs[i])) + ": " + html_escaped(note) + "</li>";
    }
  }
  return html.empty() ? "" : "<ul class='notes'>" + html + "</ul>";
}

/// "key" -> value of every line of a config.toml, keys with their table's name.
std::map<std::string, std::string> flat_config(const std::string& toml) {
  std::map<std::string, std::string> values;
  std::string table;
  for (const io::TextLine& line : io::content_lines(toml)) {
    if (line.text.front() == '[') {
      table = std::string(line.text.substr(1, line.text.find(']') - 1)) + ".";
      continue;
    }
    const auto equals = line.text.find('=');
    if (equals == std::string_view::npos) continue;
    const auto trimmed = [](std::string_view text) {
      const auto first = text.find_first_not_of(" \t"), last = text.find_last_not_of(" \t");
      return first == std::string_view::npos ? std::string()
                                             : std::string(text.substr(first, last - first + 1));
    };
    values[table + trimmed(line.text.substr(0, equals))] = trimmed(line.text.substr(equals + 1));
  }
  return values;
}

}  // namespace

std::vector<std::size_t> best_runs(const std::string& label,
                                   const std::vector<eval::Metrics>& runs) {
  const int direction = better_direction(label);
  std::vector<std::size_t> best;
  if (direction == 0) return best;
  double best_value = 0;
  std::size_t measured = 0;
  bool all_equal = true;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const auto lines = eval::metric_lines(runs[i]);
    const auto line = std::find_if(lines.begin(), lines.end(),
                                   [&](const eval::MetricLine& l) { return l.label == label; });
    // As printed: what reads the same is the same.
    const auto fields =
        line == lines.end() ? std::vector<std::string_view>{} : io::split_fields(line->value);
    const auto value = fields.empty() ? std::nullopt : io::parse_double(fields[0]);
    if (!value) continue;
    const double score = direction * *value;
    if (measured > 0 && score != best_value) all_equal = false;
    if (measured == 0 || score > best_value) {
      best_value = score;
      best = {i};
    } else if (score == best_value) {
      best.push_back(i);
    }
    ++measured;
  }
  return measured < 2 || all_equal ? std::vector<std::size_t>{} : best;
}

std::vector<ConfigDifference> config_differences(const std::vector<std::string>& config_tomls) {
  std::vector<std::map<std::string, std::string>> configs;
  std::map<std::string, bool> keys;
  for (const std::string& toml : config_tomls) {
    configs.push_back(flat_config(toml));
    for (const auto& [key, value] : configs.back()) keys[key] = true;
  }
  std::vector<ConfigDifference> differences;
  for (const auto& [key, unused] : keys) {
    ConfigDifference difference{key, {}};
    for (const auto& config : configs) {
      const auto found = config.find(key);
      difference.values.push_back(found == config.end() ? "" : found->second);
    }
    const auto& v = difference.values;
    if (std::any_of(v.begin(), v.end(), [&](const auto& value) { return value != v[0]; })) {
      differences.push_back(std::move(difference));
    }
  }
  return differences;
}

std::string comparison_html(Runs runs) {
  SGS_CHECK(!runs.empty(), "a comparison needs runs");
  std::string title;
  bool same_input = true;
  for (const ReportData& run : runs) {
    check_columns(run);
    same_input = same_input && run.title == runs[0].title;
  }
  title = same_input ? runs[0].title : "Comparison";
  std::string body = "<h1>" + html_escaped(title) + "</h1><p class='sub'>" +
                     fmt::format("{} runs compared", runs.size()) + "</p><div class='tags'>";
  for (std::size_t i = 0; i < runs.size(); ++i) {
    body += fmt::format("<span>{}<b>run {}</b> {}</span>", key_html(i), i + 1,
                        html_escaped(run_name(runs[i]) + ": " + runs[i].subtitle));
  }
  body += "</div>" + table_section(runs);
  if (same_input) {
    body += section_html("Trajectories", "",
                         scene_html(runs) + figures_html(trajectory_drawings(runs), true));
    body += section_html("Tracking", "", figures_html(error_drawings(runs)) + unseen_figure(runs));
    body += picture_section(runs);
  } else {
    body +=
        "<p class='lead'>The runs saw different sequences; their paths are not drawn into one "
        "picture.</p>";
  }
  body += config_section(runs) + notes_html(runs);
  return page_html(title, body);
}

Status save_comparison(const std::filesystem::path& path, Runs runs) {
  return io::write_file(path, comparison_html(runs));
}

}  // namespace sgs::report
