// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/report/comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string_view>

#include "sgs/io/atomic_file.h"
#include "sgs/io/text.h"
#include "sgs/report/html.h"
#include "sgs/report/page.h"
#include "sgs/report/scene.h"

namespace sgs::report {
namespace {

std::string key_html(std::size_t run) {
  return fmt::format("<span class='key c{}'></span>", run % 6);
}

/// Rows of all metrics, or of those that matter most.
std::string table_html(Runs runs, bool all) {
  std::vector<eval::Metrics> metrics;
  std::vector<std::vector<eval::MetricLine>> columns;
  std::string html = "<div class='scroll'><table><tr><th></th>";
  for (std::size_t i = 0; i < runs.size(); ++i) {
    metrics.push_back(runs[i].metrics);
    columns.push_back(eval::metric_lines(runs[i].metrics));
    html += "<th class='v'>" + key_html(i) + html_escaped(run_name(runs[i])) + "</th>";
  }
  html += "</tr>";
  std::string_view group;
  for (std::size_t line = 0; line < columns[0].size(); ++line) {
    const eval::MetricInfo& info = columns[0][line].info;
    if (!all && info.rank == eval::Rank::kDetail) continue;
    if (all && info.group != group) {
      group = info.group;
      html += fmt::format("<tr class='group'><td colspan='{}'><h3>{}</h3></td></tr>",
                          runs.size() + 1, html_escaped(group));
    }
    const auto best = eval::best_runs(info.key, metrics);
    html += fmt::format("<tr><td title='{}'>{}</td>", html_escaped(info.meaning),
                        html_escaped(info.label));
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
  return section_html("Scores side by side", "★ marks the best value.",
                      table_html(runs, false) + "<details><summary>All scores</summary>" +
                          table_html(runs, true) + "</details>");
}

std::string unseen_figure(Runs runs) {
  PlotFigure figure;
  figure.title = "Weight of vision on the least seen axis, by run";
  figure.x_label = "time [s]";
  PlotPanel panel;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const Column weights = axis_column(runs[i], &tracker::Diagnostics::weights, 0);
    if (has_data(weights)) {
      panel.rows.push_back({fmt::format("run {}", i + 1), time_s(runs[i]), weights, {}});
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
