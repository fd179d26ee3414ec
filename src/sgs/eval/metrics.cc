// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/eval/metrics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <type_traits>

#include "sgs/eval/run_evaluator.h"
#include "sgs/eval/trajectory_metrics.h"
#include "sgs/io/atomic_file.h"

namespace sgs::eval {
namespace {

/// Calls `visit(key, field)` for every field in the order of metrics.json.
template <class M, class Visit>
void for_each_field(M& m, const Visit& visit) {
  visit("frames", m.frames);
  visit("frames_tracked", m.frames_tracked);
  visit("frames_lost", m.frames_lost);
  visit("tracked_percent", m.tracked_percent);
  visit("ate_rmse_m", m.ate_rmse_m);
  visit("ate_mean_m", m.ate_mean_m);
  visit("ate_median_m", m.ate_median_m);
  visit("ate_max_m", m.ate_max_m);
  visit("rpe_trans_1s_m", m.rpe_trans_1s_m);
  visit("rpe_rot_1s_deg", m.rpe_rot_1s_deg);
  visit("psnr_db", m.psnr_db);
  visit("ssim", m.ssim);
  visit("lpips", m.lpips);
  visit("psnr_db_full", m.psnr_db_full);
  visit("ssim_full", m.ssim_full);
  visit("lpips_full", m.lpips_full);
  visit("psnr_db_heldout", m.psnr_db_heldout);
  visit("ssim_heldout", m.ssim_heldout);
  visit("lpips_heldout", m.lpips_heldout);
  visit("depth_l1_m", m.depth_l1_m);
  visit("gaussians", m.gaussians);
  visit("map_bytes", m.map_bytes);
  visit("keyframes", m.keyframes);
  visit("mapping_iterations", m.mapping_iterations);
  visit("fps_system", m.fps_system);
  visit("fps_wall", m.fps_wall);
  visit("track_ms_p50", m.track_ms_p50);
  visit("track_ms_p95", m.track_ms_p95);
  visit("map_iteration_ms_p50", m.map_iteration_ms_p50);
  visit("peak_rss_bytes", m.peak_rss_bytes);
  visit("degenerate_percent", m.degenerate_percent);
  visit("prior_percent", m.prior_percent);
  visit("frames_dropped", m.frames_dropped);
  visit("seed", m.seed);
  visit("threads", m.threads);
  visit("preset", m.preset);
  visit("tracker", m.tracker);
  visit("version", m.version);
}

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

using Real = Metrics::Real;
using Count = Metrics::Count;

std::string number(const Real& value, double factor, int digits, const char* unit) {
  if (!value || !std::isfinite(*value)) return "n/a";
  return fmt::format("{:.{}f}{}{}", *value * factor, digits, *unit == '\0' ? "" : " ", unit);
}
std::string count(const Count& value) { return value ? fmt::format("{}", *value) : "n/a"; }
Real real(const Count& value) { return value ? Real(static_cast<double>(*value)) : std::nullopt; }

std::string padded(const std::string& text, std::size_t width, bool right) {
  const std::string space(width > text.size() ? width - text.size() : 0, ' ');
  return right ? space + text : text + space;
}

}  // namespace

void Metrics::set(const TrajectoryMetrics& t) {
  tracked_percent = t.tracked_percent;
  ate_rmse_m = ate_mean_m = ate_median_m = ate_max_m = std::nullopt;
  if (t.ate) {
    ate_rmse_m = t.ate->rmse;
    ate_mean_m = t.ate->mean;
    ate_median_m = t.ate->median;
    ate_max_m = t.ate->max;
  }
  rpe_trans_1s_m = rpe_rot_1s_deg = std::nullopt;
  if (t.rpe_1s) {
    rpe_trans_1s_m = t.rpe_1s->translation_rmse_m;
    rpe_rot_1s_deg = t.rpe_1s->rotation_rmse_deg;
  }
}

void Metrics::set(const RunEvaluation& r) {
  psnr_db = r.gsicp.psnr_db;
  ssim = r.gsicp.ssim;
  lpips = r.gsicp.lpips;
  psnr_db_full = r.full.psnr_db;
  ssim_full = r.full.ssim;
  lpips_full = r.full.lpips;
  psnr_db_heldout = r.heldout.psnr_db;
  ssim_heldout = r.heldout.ssim;
  lpips_heldout = r.heldout.lpips;
  depth_l1_m = r.depth_l1_m;
}

std::string to_json(const Metrics& metrics) {
  nlohmann::ordered_json json;
  for_each_field(metrics, [&](const char* key, const auto& field) {
    using T = typename std::decay_t<decltype(field)>::value_type;
    json[key] = nullptr;
    if (!field) return;
    if constexpr (std::is_same_v<T, double>) {
      if (!std::isfinite(*field)) return;
    }
    json[key] = *field;
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
  std::string wrong_key;
  for_each_field(metrics, [&](const char* key, auto& field) {
    const auto found = json.find(key);
    if (found != json.end() && !read_value(*found, field) && wrong_key.empty()) wrong_key = key;
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

std::vector<MetricLine> metric_lines(const Metrics& m) {
  const std::string t = "Trajectory", r = "Rendering", s = "Speed", p = "Map", u = "Run";
  constexpr double kCm = 100, kMiB = 1.0 / (1024 * 1024);
  return {
      {t, "ATE RMSE", number(m.ate_rmse_m, kCm, 2, "cm")},
      {t, "ATE mean", number(m.ate_mean_m, kCm, 2, "cm")},
      {t, "ATE median", number(m.ate_median_m, kCm, 2, "cm")},
      {t, "ATE max", number(m.ate_max_m, kCm, 2, "cm")},
      {t, "RPE 1 s, translation", number(m.rpe_trans_1s_m, kCm, 2, "cm")},
      {t, "RPE 1 s, rotation", number(m.rpe_rot_1s_deg, 1, 3, "deg")},
      {t, "Tracked", number(m.tracked_percent, 1, 1, "%")},
      {t, "Frames", count(m.frames)},
      {t, "Frames tracked", count(m.frames_tracked)},
      {t, "Frames lost", count(m.frames_lost)},
      {t, "Frames dropped", count(m.frames_dropped)},
      {t, "Degenerate", number(m.degenerate_percent, 1, 1, "%")},
      {t, "Prior active", number(m.prior_percent, 1, 1, "%")},
      {r, "PSNR (gsicp)", number(m.psnr_db, 1, 2, "dB")},
      {r, "PSNR (full)", number(m.psnr_db_full, 1, 2, "dB")},
      {r, "PSNR (held out)", number(m.psnr_db_heldout, 1, 2, "dB")},
      {r, "SSIM (gsicp)", number(m.ssim, 1, 4, "")},
      {r, "SSIM (full)", number(m.ssim_full, 1, 4, "")},
      {r, "SSIM (held out)", number(m.ssim_heldout, 1, 4, "")},
      {r, "LPIPS (gsicp)", number(m.lpips, 1, 4, "")},
      {r, "LPIPS (full)", number(m.lpips_full, 1, 4, "")},
      {r, "LPIPS (held out)", number(m.lpips_heldout, 1, 4, "")},
      {r, "Depth L1", number(m.depth_l1_m, kCm, 2, "cm")},
      {p, "Gaussians", count(m.gaussians)},
      {p, "Map size", number(real(m.map_bytes), kMiB, 2, "MiB")},
      {p, "Keyframes", count(m.keyframes)},
      {p, "Mapping iterations", count(m.mapping_iterations)},
      {s, "FPS (system)", number(m.fps_system, 1, 2, "")},
      {s, "FPS (with decoding)", number(m.fps_wall, 1, 2, "")},
      {s, "Tracking, median", number(m.track_ms_p50, 1, 1, "ms")},
      {s, "Tracking, 95th percentile", number(m.track_ms_p95, 1, 1, "ms")},
      {s, "Mapping iteration, median", number(m.map_iteration_ms_p50, 1, 1, "ms")},
      {s, "Peak memory of SLAM", number(real(m.peak_rss_bytes), kMiB, 0, "MiB")},
      {u, "Preset", m.preset.value_or("n/a")},
      {u, "Tracker", m.tracker.value_or("n/a")},
      {u, "Threads", count(m.threads)},
      {u, "Seed", count(m.seed)},
      {u, "Version", m.version.value_or("n/a")},
  };
}

std::string metrics_table(const Metrics& metrics) {
  std::size_t label_width = 0, value_width = 0;
  const auto lines = metric_lines(metrics);
  for (const MetricLine& line : lines) {
    label_width = std::max(label_width, line.label.size());
    value_width = std::max(value_width, line.value.size());
  }
  std::string text, group;
  for (const MetricLine& line : lines) {
    if (line.group != group) text += (group.empty() ? "" : "\n") + line.group + "\n";
    group = line.group;
    text += "  " + padded(line.label, label_width, false) + "  " +
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
      label_width = std::max(label_width, line.label.size());
    }
    widths.push_back(width);
  }
  if (columns.empty()) return {};
  std::string text = padded("", label_width, false);
  for (std::size_t c = 0; c < runs.size(); ++c)
    text += "  " + padded(runs[c].first, widths[c], true);
  text += "\n";
  for (std::size_t i = 0; i < columns[0].size(); ++i) {
    text += padded(columns[0][i].label, label_width, false);
    for (std::size_t c = 0; c < columns.size(); ++c) {
      text += "  " + padded(columns[c][i].value, widths[c], true);
    }
    text += "\n";
  }
  return text;
}

}  // namespace sgs::eval
