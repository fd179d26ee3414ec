// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "sgs/core/error.h"

namespace sgs::eval {

struct RunEvaluation;
struct TrajectoryMetrics;

/// What a run is judged by: exactly the keys of metrics.json, in its order, SI units unless named.
/// Empty = not measured (null in the file), never 0.
struct Metrics {
  using Count = std::optional<std::int64_t>;
  using Real = std::optional<double>;
  using Text = std::optional<std::string>;

  Count frames, frames_tracked, frames_lost;
  Real tracked_percent;
  Real ate_rmse_m, ate_mean_m, ate_median_m, ate_max_m;
  Real rpe_trans_1s_m, rpe_rot_1s_deg;
  Real psnr_db, ssim, lpips;  ///< rule `gsicp`
  Real psnr_db_full, ssim_full, lpips_full;
  Real psnr_db_heldout, ssim_heldout, lpips_heldout;
  Real depth_l1_m;
  Count gaussians, map_bytes, keyframes, mapping_iterations;
  Real fps_system, fps_wall;
  Real track_ms_p50, track_ms_p95, map_iteration_ms_p50;
  Count peak_rss_bytes;  ///< of input, tracking and mapping: taken before anything is scored
  Real degenerate_percent, prior_percent;
  Count frames_dropped, seed, threads;
  Text preset, tracker, version;

  /// Takes over what an evaluation measured; the rest stays.
  void set(const TrajectoryMetrics& trajectory);
  void set(const RunEvaluation& rendering);

  friend bool operator==(const Metrics&, const Metrics&) = default;
};

/// JSON object with every key; numbers that are not finite are written as null.
std::string to_json(const Metrics& metrics);
/// Reads metrics.json. Missing keys are empty, unknown ones are ignored, wrong types are errors
/// that name the key; `source` stands for the file's name in messages.
Result<Metrics> metrics_from_json(std::string_view text, std::string_view source);
Status save_metrics(const std::filesystem::path& path, const Metrics& metrics);
Result<Metrics> load_metrics(const std::filesystem::path& path);

/// One line of a printed table: what, value as text with unit ("n/a" when empty).
struct MetricLine {
  std::string group;  ///< "Trajectory", "Rendering", "Speed", "Map", "Run"
  std::string label;
  std::string value;
};
/// The values in reading order and reading units (cm, ms, MB), grouped.
std::vector<MetricLine> metric_lines(const Metrics& metrics);

/// Aligned text for a terminal: one run.
std::string metrics_table(const Metrics& metrics);
/// Aligned text for a terminal: one column per run, named.
std::string comparison_table(std::span<const std::pair<std::string, Metrics>> runs);

}  // namespace sgs::eval
