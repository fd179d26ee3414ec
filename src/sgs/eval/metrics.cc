// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/eval/metrics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <type_traits>

#include "sgs/io/atomic_file.h"

namespace sgs::eval {
namespace {

template <class T>
bool read_value(const nlohmann::json& json, std::optional<T>& field) {
  if (json.is_null()) {
    field.reset();
    return true;
  }
  if constexpr (std::is_same_v<T, std::string>) {
    if (!json.is_string()) return false;
  } else if constexpr (std::is_same_v<T, std::int64_t>) {
    // An unsigned value beyond the signed range would wrap around.
    if (!json.is_number_integer()) return false;
    if (json.is_number_unsigned() &&
        json.get<std::uint64_t>() >
            static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max())) {
      return false;
    }
  } else {
    if (!json.is_number()) return false;
  }
  field = json.get<T>();
  return true;
}

std::string value_text(const MetricInfo&, const Metrics::Text& value) {
  return value.value_or("n/a");
}
template <class T>
std::string value_text(const MetricInfo& info, const std::optional<T>& value) {
  const double number = value ? static_cast<double>(*value) * info.factor : NAN;
  if (!std::isfinite(number)) return "n/a";
  return fmt::format("{:.{}f}{}{}", number, info.digits, info.unit.empty() ? "" : " ", info.unit);
}

std::string padded(std::string_view text, std::size_t width, bool right) {
  const std::string space(width > text.size() ? width - text.size() : 0, ' ');
  return right ? space + std::string(text) : std::string(text) + space;
}

}  // namespace

void replace_group(Metrics& metrics, std::string_view group, const Metrics& measured) {
  visit_metrics(metrics, [&](const MetricInfo& to, auto& field) {
    visit_metrics(measured, [&](const MetricInfo& from, const auto& value) {
      if constexpr (std::is_same_v<std::decay_t<decltype(field)>, std::decay_t<decltype(value)>>) {
        if (to.group == group && to.key == from.key) field = value;
      }
    });
  });
}

std::string to_json(const Metrics& metrics) {
  nlohmann::ordered_json json;
  visit_metrics(metrics, [&](const MetricInfo& info, const auto& field) {
    using T = typename std::decay_t<decltype(field)>::value_type;
    auto& value = json[std::string(info.key)];
    value = nullptr;
    if (!field) return;
    if constexpr (std::is_same_v<T, double>) {
      if (!std::isfinite(*field)) return;
    }
    value = *field;
  });
  // Text that is not UTF-8 must not make the file unwritable.
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

Result<Metrics> metrics_from_json(std::string_view text, std::string_view source) {
  const auto json = nlohmann::json::parse(text, nullptr, false);
  if (json.is_discarded() || !json.is_object()) {
    return fail(ErrorCode::kInvalidFormat, fmt::format("{}: not a JSON object", source),
                "expected the metrics.json of a run");
  }
  Metrics metrics;
  std::string_view wrong_key;
  visit_metrics(metrics, [&](const MetricInfo& info, auto& field) {
    const auto found = json.find(info.key);
    if (found != json.end() && !read_value(*found, field) && wrong_key.empty()) {
      wrong_key = info.key;
    }
  });
  if (!wrong_key.empty()) {
    return fail(ErrorCode::kInvalidFormat,
                fmt::format("{}: '{}' has the wrong type", source, wrong_key),
                "expected a number (text for preset, tracker, version) or null");
  }
  return metrics;
}

Status save_metrics(const std::filesystem::path& path, const Metrics& metrics) {
  return io::write_file(path, to_json(metrics));
}

Result<Metrics> load_metrics(const std::filesystem::path& path) {
  SGS_ASSIGN_OR_RETURN(const std::string text, io::read_file(path));
  return metrics_from_json(text, path.string());
}

std::vector<MetricLine> metric_lines(const Metrics& metrics) {
  std::vector<MetricLine> lines;
  visit_metrics(metrics, [&](const MetricInfo& info, const auto& field) {
    lines.push_back({info, value_text(info, field)});
  });
  return lines;
}

std::vector<std::size_t> best_runs(std::string_view key, std::span<const Metrics> runs) {
  std::vector<std::size_t> best;
  std::optional<double> best_score;
  std::size_t measured = 0;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    visit_metrics(runs[i], [&](const MetricInfo& info, const auto& field) {
      using T = typename std::decay_t<decltype(field)>::value_type;
      if constexpr (!std::is_same_v<T, std::string>) {
        if (info.key != key || info.better == Better::kNeither || !field) return;
        // As printed: what reads the same is the same.
        const double rounding = std::pow(10, info.digits);
        const double printed = std::round(static_cast<double>(*field) * info.factor * rounding);
        const double score = info.better == Better::kLess ? -printed : printed;
        if (!std::isfinite(score)) return;
        ++measured;
        if (!best_score || score > *best_score) best.clear();
        if (!best_score || score >= *best_score) best.push_back(i);
        best_score = std::max(score, best_score.value_or(score));
      }
    });
  }
  const bool all_equal = best.size() == measured;
  return measured < 2 || all_equal ? std::vector<std::size_t>{} : best;
}

std::string metrics_table(const Metrics& metrics) {
  std::size_t label_width = 0, value_width = 0;
  const auto lines = metric_lines(metrics);
  for (const MetricLine& line : lines) {
    label_width = std::max(label_width, line.info.label.size());
    value_width = std::max(value_width, line.value.size());
  }
  std::string text;
  std::string_view group;
  for (const MetricLine& line : lines) {
    if (line.info.group != group) {
      text += fmt::format("{}{}\n", group.empty() ? "" : "\n", line.info.group);
    }
    group = line.info.group;
    text += "  " + padded(line.info.label, label_width, false) + "  " +
            padded(line.value, value_width, true) + "\n";
  }
  return text;
}

std::string comparison_table(std::span<const std::pair<std::string, Metrics>> runs) {
  std::vector<std::vector<MetricLine>> columns;
  std::vector<std::size_t> widths;
  std::size_t label_width = 0;
  for (const auto& [name, metrics] : runs) {
    columns.push_back(metric_lines(metrics));
    std::size_t width = name.size();
    for (const MetricLine& line : columns.back()) {
      width = std::max(width, line.value.size());
      label_width = std::max(label_width, line.info.label.size());
    }
    widths.push_back(width);
  }
  if (columns.empty()) return {};
  std::string text = padded("", label_width, false);
  for (std::size_t c = 0; c < runs.size(); ++c)
    text += "  " + padded(runs[c].first, widths[c], true);
  text += "\n";
  for (std::size_t i = 0; i < columns[0].size(); ++i) {
    text += padded(columns[0][i].info.label, label_width, false);
    for (std::size_t c = 0; c < columns.size(); ++c) {
      text += "  " + padded(columns[c][i].value, widths[c], true);
    }
    text += "\n";
  }
  return text;
}

std::string metrics_markdown() {
  std::string text = "| key | shown as | unit | better | meaning |\n|---|---|---|---|---|\n";
  visit_metrics(Metrics{}, [&](const MetricInfo& info, const auto&) {
    const char* better = info.better == Better::kLess   ? "less"
                         : info.better == Better::kMore ? "more"
                                                        : "";
    text += fmt::format("| `{}` | {}: {} | {} | {} | {} |\n", info.key, info.group, info.label,
                        info.unit, better, info.meaning);
  });
  return text;
}

}  // namespace sgs::eval
