// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <regex>

#include "commands.h"
#include "sgs/io/atomic_file.h"
#include "sgs/report/plot/canvas.h"
#include "sgs/report/plot/plot.h"
#include "suite.h"

namespace sgs::app {
namespace {

struct SweepCommand {
  std::string range, variant = "paper";
  int per_octave = 1;
  SuiteOptions options;
};

struct SweepRange {
  std::string key;
  std::vector<double> values;
};

// The names the literature uses for parameters that have a place in our configuration.
const std::map<std::string, std::string>& aliases() {
  static const std::map<std::string, std::string> names = {
      {"tau_deg", "tracker.degeneracy.condition_threshold"},
      {"snr_threshold", "tracker.degeneracy.snr_threshold"},
      {"geometry_weight", "tracker.degeneracy.geometry_weight"},
  };
  return names;
}

/// KEY=A:B -> geometric steps from A to B, `per_octave` of them in each doubling.
Result<SweepRange> parse_range(const std::string& text, int per_octave) {
  static const std::regex form(R"(([A-Za-z0-9_.]+)=([0-9.eE+-]+):([0-9.eE+-]+))");
  std::smatch match;
  const auto wrong = [&] {
    return fail(ErrorCode::kInvalidArgument, fmt::format("'{}' is no range", text),
                "write KEY=A:B with 0 < A <= B, e.g. tau_deg=25:3200");
  };
  if (!std::regex_match(text, match, form)) return wrong();
  const double from = std::strtod(match[2].str().c_str(), nullptr);
  const double to = std::strtod(match[3].str().c_str(), nullptr);
  if (!(from > 0) || !(to >= from) || !std::isfinite(to)) return wrong();
  const auto alias = aliases().find(match[1]);
  SweepRange range{alias == aliases().end() ? match[1].str() : alias->second, {}};
  const int steps = std::max(1, static_cast<int>(std::lround(std::log2(to / from) * per_octave)));
  for (int i = 0; i <= steps; ++i) {
    range.values.push_back(from * std::pow(to / from, static_cast<double>(i) / steps));
    if (to == from) break;
  }
  return range;
}

std::string value_name(double value) { return fmt::format("{:.6g}", value); }

struct SweepTable {
  SweepRange range;
  std::vector<std::string> columns;                           ///< SEQUENCE LEVEL
  std::vector<std::vector<std::vector<eval::Metrics>>> runs;  ///< column, value, seed
};

SweepTable tabulate(const SweepRange& range, const std::vector<SuiteJob>& jobs) {
  SweepTable table{range, {}, {}};
  for (const SuiteJob& job : jobs) {
    const std::string name = job.sequence + " " + job.level;
    const auto found = std::find(table.columns.begin(), table.columns.end(), name);
    const auto column = static_cast<std::size_t>(found - table.columns.begin());
    if (found == table.columns.end()) {
      table.columns.push_back(name);
      table.runs.emplace_back(range.values.size());
    }
    const auto metrics = job_metrics(job);
    if (!metrics) continue;
    for (std::size_t v = 0; v < range.values.size(); ++v) {
      if (value_name(range.values[v]) == job.variant) table.runs[column][v].push_back(*metrics);
    }
  }
  return table;
}

void print_table(const SweepTable& table, const std::string& variant) {
  fmt::print("{} of `{}`: ATE RMSE in cm, mean (worst) over seeds\n{:>10}", table.range.key,
             variant, "");
  for (const std::string& column : table.columns) fmt::print(" {:>22}", column);
  fmt::print("\n");
  for (std::size_t v = 0; v < table.range.values.size(); ++v) {
    fmt::print("{:>10}", value_name(table.range.values[v]));
    for (const auto& column : table.runs) fmt::print(" {:>22}", ate_cell(column[v]));
    fmt::print("\n");
  }
}

/// Mean error over the logarithm of the parameter, one line per sequence.
std::string sweep_plot(const SweepTable& table) {
  constexpr int kColors = 6;
  report::PlotPanel panel;
  panel.y_label = "ATE RMSE, cm";
  panel.log_y = true;
  panel.height = 300;
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    report::PlotSeries series;
    series.label = table.columns[c];
    series.color = static_cast<int>(c) % kColors;
    series.dashed = c >= kColors;
    for (std::size_t v = 0; v < table.range.values.size(); ++v) {
      double sum = 0;
      for (const auto& m : table.runs[c][v]) sum += 100 * m.ate_rmse_m.value_or(NAN);
      series.x.push_back(std::log2(table.range.values[v]));
      series.y.push_back(sum / static_cast<double>(table.runs[c][v].size()));
    }
    panel.series.push_back(std::move(series));
  }
  report::PlotFigure figure;
  figure.title = "Trajectory error over " + table.range.key;
  figure.x_label = "log2 of " + table.range.key;
  figure.panels = {std::move(panel)};
  figure.over_time = false;
  const std::string svg = report::figure_svg(figure);
  return svg.empty() ? svg : report::standalone_svg({"sweep", "", svg});
}

int run_sweep(const SweepCommand& command) {
  const auto range = parse_range(command.range, command.per_octave);
  if (!range) return report(range.error());
  const auto base = find_variant(command.variant);
  if (!base) return report(base.error());
  SuiteOptions options = command.options;
  for (const double value : range->values) {
    SuiteVariant variant = *base;
    variant.name = value_name(value);
    variant.arguments.insert(variant.arguments.end(),
                             {"--set", fmt::format("{}={:.6g}", range->key, value)});
    options.variants.push_back(std::move(variant));
  }
  const auto outcome = run_suite(options);
  if (!outcome) return report(outcome.error());

  const SweepTable table = tabulate(*range, outcome->jobs);
  print_table(table, command.variant);
  const auto plot = std::filesystem::path(options.output) / "sweep.svg";
  if (auto written = io::write_file(plot, sweep_plot(table)); !written) {
    return report(written.error());
  }
  fmt::print("{}\n", plot.string());
  return outcome->exit_code();
}

}  // namespace

void add_sweep(CLI::App& app, Action& action) {
  auto command = std::make_shared<SweepCommand>();
  command->options.output = "runs/sweep";
  command->options.levels = {"kinect"};
  command->options.seeds = {1};
  command->options.filter = "^(nostruct|notex)";
  auto* sub = app.add_subcommand("sweep", "Run the suite over a range of one parameter, plot it");
  sub->add_option("RANGE", command->range,
                  "KEY=A:B in doublings; KEY is a parameter or tau_deg, snr_threshold, "
                  "geometry_weight")
      ->required();
  sub->add_option("--variant", command->variant, "What is swept, see `sgs bench --variants`");
  sub->add_option("--per-octave", command->per_octave, "Values per doubling")
      ->check(CLI::Range(1, 16));
  add_suite_options(*sub, command->options);
  sub->callback([command, &action] { action = [command] { return run_sweep(*command); }; });
}

}  // namespace sgs::app
