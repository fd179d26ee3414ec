// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sgs/core/error.h"

namespace sgs::eval {

/// What a run is judged by: the keys of metrics.json, SI units unless named. Empty = not measured
/// (null in the file), never 0. What each one means is said below, in visit_metrics().
struct Metrics {
  using Count = std::optional<std::int64_t>;
  using Real = std::optional<double>;
  using Text = std::optional<std::string>;

  Real ate_rmse_m, ate_online_rmse_m, ate_mean_m, ate_median_m, ate_max_m;
  Real rpe_trans_1s_m, rpe_rot_1s_deg;
  Real scale_error_percent, tracked_percent;
  Count frames, frames_tracked, frames_lost;
  Real degenerate_percent, prior_percent;
  Real psnr_db, psnr_db_full, psnr_db_train, psnr_db_heldout, psnr_db_exposed, psnr_db_novel;
  Real ssim, ssim_full, ssim_train, ssim_heldout, ssim_novel;
  Real lpips, lpips_full, lpips_train, lpips_heldout, lpips_novel;
  Real depth_l1_m, depth_l1_novel_m;
  Text pictures;
  Count gaussians, map_bytes, keyframes, mapping_iterations;
  Count loops_accepted, loops_rejected, corrections;
  Text upright;
  Real fps_system, fps_wall;
  Real track_ms_p50, track_ms_p95, map_iteration_ms_p50;
  Count frames_dropped, peak_rss_bytes;
  Text preset, tracker;
  Count threads, seed;
  Text version, host, cpu, state;

  friend bool operator==(const Metrics&, const Metrics&) = default;
};

/// Where a metric is shown.
enum class Rank {
  kTile,    ///< large, at the top of a report; also kMain
  kMain,    ///< in the short table of a comparison
  kDetail,  ///< in the full tables only
};

/// Whether a smaller or a larger value is the better one.
enum class Better { kNeither, kLess, kMore };

/// A metric: its key in metrics.json, the group and label that people read, unit, factor and digits
/// of the number they read, and what it means.
struct MetricInfo {
  std::string_view key, group, label, unit;
  double factor = 1;  ///< from the stored value to the unit
  int digits = 0;
  Better better = Better::kNeither;
  Rank rank = Rank::kDetail;
  std::string_view meaning;
};

/// Words of Metrics::pictures.
inline constexpr const char *kMeasuredPictures = "measured", *kKeptPictures = "kept";

/// Groups that one evaluation fills as a whole.
inline constexpr std::string_view kTrajectoryGroup = "Trajectory", kRenderingGroup = "Rendering";

/// The metrics, declared once: calls `visit(MetricInfo, field)` for each in reading order, groups
/// together. JSON, terminal, report, the browser's text and docs/metrics.md follow from this list.
template <class M, class Visitor>
void visit_metrics(M&& m, Visitor&& visit) {
  using I = MetricInfo;
  using enum Better;
  using enum Rank;
  constexpr double kCm = 100, kMiB = 1.0 / (1024 * 1024);
  constexpr std::string_view t = kTrajectoryGroup, r = kRenderingGroup, p = "Map", s = "Speed",
                             u = "Run";
  visit(I{"ate_rmse_m", t, "ATE RMSE", "cm", kCm, 2, kLess, kTile,
          "Absolute trajectory error after rigid alignment, root mean square over all frames with "
          "ground truth."},
        m.ate_rmse_m);
  visit(I{"ate_online_rmse_m", t, "ATE online", "cm", kCm, 2, kLess, kMain,
          "The same of the poses as they were said frame by frame, before loops were closed and "
          "depth was calibrated."},
        m.ate_online_rmse_m);
  visit(I{"ate_mean_m", t, "ATE mean", "cm", kCm, 2, kLess, kDetail, "Its mean."}, m.ate_mean_m);
  visit(I{"ate_median_m", t, "ATE median", "cm", kCm, 2, kLess, kDetail, "Its median."},
        m.ate_median_m);
  visit(I{"ate_max_m", t, "ATE max", "cm", kCm, 2, kLess, kMain, "Its largest value."},
        m.ate_max_m);
  visit(I{"rpe_trans_1s_m", t, "RPE 1 s, translation", "cm", kCm, 2, kLess, kDetail,
          "Relative pose error over one second, translation, root mean square."},
        m.rpe_trans_1s_m);
  visit(I{"rpe_rot_1s_deg", t, "RPE 1 s, rotation", "deg", 1, 3, kLess, kDetail,
          "Relative pose error over one second, rotation, root mean square."},
        m.rpe_rot_1s_deg);
  visit(I{"scale_error_percent", t, "Scale error", "%", 1, 2, kNeither, kDetail,
          "How much larger the estimated path is than the true one; the alignment for the ATE does "
          "not correct it."},
        m.scale_error_percent);
  visit(I{"tracked_percent", t, "Tracked", "%", 1, 1, kMore, kTile,
          "Share of the sequence's frames with a pose within 1 m of the truth after alignment."},
        m.tracked_percent);
  visit(I{"frames", t, "Frames", "", 1, 0, kNeither, kDetail,
          "Frames of the sequence, bad and dropped ones included."},
        m.frames);
  visit(I{"frames_tracked", t, "Frames tracked", "", 1, 0, kNeither, kDetail,
          "Frames whose pose the tracker trusted."},
        m.frames_tracked);
  visit(I{"frames_lost", t, "Frames lost", "", 1, 0, kLess, kDetail,
          "Frames whose pose it did not trust."},
        m.frames_lost);
  visit(I{"degenerate_percent", t, "Degenerate", "%", 1, 1, kNeither, kMain,
          "Share of tracked frames whose geometry left a direction unobserved."},
        m.degenerate_percent);
  visit(I{"prior_percent", t, "Prior active", "%", 1, 1, kNeither, kMain,
          "Share of tracked frames in which vision or a prior filled such a direction."},
        m.prior_percent);
  visit(I{"psnr_db", r, "PSNR (gsicp)", "dB", 1, 2, kMore, kTile,
          "Mean PSNR over all frames; pixels without measured depth are zeroed in both pictures "
          "and counted (rule of GS-ICP SLAM)."},
        m.psnr_db);
  visit(I{"psnr_db_full", r, "PSNR (full)", "dB", 1, 2, kMore, kDetail,
          "Mean PSNR over all frames and all pixels that the camera saw: not the rim that removing "
          "a lens leaves."},
        m.psnr_db_full);
  visit(I{"psnr_db_train", r, "PSNR (training)", "dB", 1, 2, kMore, kDetail,
          "Mean PSNR over the frames that are not held out, pixels as for psnr_db_full; much above "
          "the held-out one means learnt by heart."},
        m.psnr_db_train);
  visit(I{"psnr_db_heldout", r, "PSNR (held out)", "dB", 1, 2, kMore, kTile,
          "Mean PSNR over the frames that the mapper never saw, pixels as for psnr_db_full."},
        m.psnr_db_heldout);
  visit(I{"psnr_db_exposed", r, "PSNR (held out, exposed)", "dB", 1, 2, kMore, kMain,
          "The same, the map made as bright as the frames before and after in time were (refined "
          "runs only): nothing is fitted to the held-out picture."},
        m.psnr_db_exposed);
  visit(
      I{"psnr_db_novel", r, "PSNR (novel views)", "dB", 1, 2, kMore, kMain,
        "Mean PSNR of views off the path against the generator's truth (synthetic input only), up "
        "to one gain per channel of the whole map."},
      m.psnr_db_novel);
  visit(I{"ssim", r, "SSIM (gsicp)", "", 1, 4, kMore, kDetail, "Mean SSIM, pixels as for psnr_db."},
        m.ssim);
  visit(I{"ssim_full", r, "SSIM (full)", "", 1, 4, kMore, kDetail,
          "Mean SSIM, pixels as for psnr_db_full."},
        m.ssim_full);
  visit(I{"ssim_train", r, "SSIM (training)", "", 1, 4, kMore, kDetail,
          "Mean SSIM over the frames that are not held out."},
        m.ssim_train);
  visit(I{"ssim_heldout", r, "SSIM (held out)", "", 1, 4, kMore, kDetail,
          "Mean SSIM over the frames that the mapper never saw."},
        m.ssim_heldout);
  visit(I{"ssim_novel", r, "SSIM (novel views)", "", 1, 4, kMore, kDetail,
          "Mean SSIM, views as for psnr_db_novel."},
        m.ssim_novel);
  visit(I{"lpips", r, "LPIPS (gsicp)", "", 1, 4, kLess, kMain,
          "Mean LPIPS (AlexNet, v0.1), pixels as for psnr_db; needs --lpips-weights."},
        m.lpips);
  visit(I{"lpips_full", r, "LPIPS (full)", "", 1, 4, kLess, kDetail,
          "Mean LPIPS, pixels as for psnr_db_full."},
        m.lpips_full);
  visit(I{"lpips_train", r, "LPIPS (training)", "", 1, 4, kLess, kDetail,
          "Mean LPIPS over the frames that are not held out."},
        m.lpips_train);
  visit(I{"lpips_heldout", r, "LPIPS (held out)", "", 1, 4, kLess, kDetail,
          "Mean LPIPS over the frames that the mapper never saw."},
        m.lpips_heldout);
  visit(I{"lpips_novel", r, "LPIPS (novel views)", "", 1, 4, kLess, kDetail,
          "Mean LPIPS, views as for psnr_db_novel."},
        m.lpips_novel);
  visit(I{"depth_l1_m", r, "Depth L1", "cm", kCm, 2, kLess, kMain,
          "Mean absolute difference of rendered and measured depth where both exist."},
        m.depth_l1_m);
  visit(I{"depth_l1_novel_m", r, "Depth L1 (novel views)", "cm", kCm, 2, kLess, kDetail,
          "Mean absolute difference of rendered and true depth, views as for psnr_db_novel."},
        m.depth_l1_novel_m);
  visit(
      I{"pictures", r, "Pictures", "", 1, 0, kNeither, kDetail,
        "Whether these scores of pictures were `measured` when the run was scored last, or `kept` "
        "from an earlier time because its recording could not be opened."},
      m.pictures);
  visit(I{"gaussians", p, "Gaussians", "", 1, 0, kNeither, kTile, "Gaussians of the final map."},
        m.gaussians);
  visit(I{"map_bytes", p, "Map size", "MiB", kMiB, 2, kNeither, kDetail,
          "Memory of these Gaussians."},
        m.map_bytes);
  visit(I{"keyframes", p, "Keyframes", "", 1, 0, kNeither, kDetail, "Keyframes of the mapper."},
        m.keyframes);
  visit(I{"loops_accepted", p, "Loops closed", "", 1, 0, kNeither, kDetail,
          "Pairs of places that were found to be one, and are in the pose graph."},
        m.loops_accepted);
  visit(I{"loops_rejected", p, "Loops rejected", "", 1, 0, kNeither, kDetail,
          "Pairs that looked alike and were not believed."},
        m.loops_rejected);
  visit(I{"corrections", p, "Corrections", "", 1, 0, kNeither, kDetail,
          "How often closing loops moved trajectory and map."},
        m.corrections);
  visit(I{"upright", p, "Upright by", "", 1, 0, kNeither, kDetail,
          "By what it is known which way is up: `accelerometer`, `floor`, both "
          "(`accelerometer_and_floor`), or only how the `camera` was held."},
        m.upright);
  visit(I{"mapping_iterations", p, "Mapping iterations", "", 1, 0, kNeither, kDetail,
          "Mapping steps of the whole run."},
        m.mapping_iterations);
  visit(I{"fps_system", s, "FPS (system)", "", 1, 2, kMore, kTile,
          "Frames per second without the time spent waiting for decoded images."},
        m.fps_system);
  visit(I{"fps_wall", s, "FPS (with decoding)", "", 1, 2, kMore, kDetail,
          "Frames per second from the first frame to the finished map."},
        m.fps_wall);
  visit(I{"track_ms_p50", s, "Tracking, median", "ms", 1, 1, kLess, kMain,
          "CPU time of tracking a frame, median."},
        m.track_ms_p50);
  visit(I{"track_ms_p95", s, "Tracking, 95th percentile", "ms", 1, 1, kLess, kDetail,
          "CPU time of tracking a frame, 95th percentile."},
        m.track_ms_p95);
  visit(I{"map_iteration_ms_p50", s, "Mapping iteration, median", "ms", 1, 1, kLess, kDetail,
          "Time of a mapping step, median."},
        m.map_iteration_ms_p50);
  visit(I{"frames_dropped", s, "Frames dropped", "", 1, 0, kNeither, kDetail,
          "Frames that came too fast in a live run."},
        m.frames_dropped);
  visit(I{"peak_rss_bytes", s, "Peak memory of SLAM", "MiB", kMiB, 0, kLess, kDetail,
          "Largest resident memory of input, tracking and mapping, before anything is scored."},
        m.peak_rss_bytes);
  visit(I{"preset", u, "Preset", "", 1, 0, kNeither, kDetail, "Where the parameters started from."},
        m.preset);
  visit(I{"tracker", u, "Tracker", "", 1, 0, kNeither, kDetail, "Type of the tracker."}, m.tracker);
  visit(I{"threads", u, "Threads", "", 1, 0, kNeither, kDetail, "Threads that the run was given."},
        m.threads);
  visit(I{"seed", u, "Seed", "", 1, 0, kNeither, kDetail, "Seed of every random choice."}, m.seed);
  visit(I{"version", u, "Version", "", 1, 0, kNeither, kDetail, "Version of sgs."}, m.version);
  visit(I{"host", u, "Host", "", 1, 0, kNeither, kDetail, "Name of the machine."}, m.host);
  visit(I{"cpu", u, "Processor", "", 1, 0, kNeither, kDetail,
          "Its processor; times of different ones are never averaged."},
        m.cpu);
  visit(I{"state", u, "State", "", 1, 0, kNeither, kDetail,
          "How far the run had come when it was scored: `finished`, `interrupted`, `running` or "
          "`killed`; but for the first, the scores are those of a part."},
        m.state);
}

/// Replaces the values of one group by those of `measured`, empty ones too.
void replace_group(Metrics& metrics, std::string_view group, const Metrics& measured);

/// JSON object with every key; numbers that are not finite are written as null.
std::string to_json(const Metrics& metrics);
/// Reads metrics.json. Missing keys are empty, unknown ones are ignored, wrong types are errors
/// that name the key; `source` stands for the file's name in messages.
Result<Metrics> metrics_from_json(std::string_view text, std::string_view source);
Status save_metrics(const std::filesystem::path& path, const Metrics& metrics);
Result<Metrics> load_metrics(const std::filesystem::path& path);

/// One line of a printed table: what, value as text with unit ("n/a" when empty).
struct MetricLine {
  MetricInfo info;
  std::string value;
};
/// The values in reading order and reading units (cm, ms, MiB), grouped.
std::vector<MetricLine> metric_lines(const Metrics& metrics);
/// The runs with the best value of a metric, as it is printed; none where it knows no better, where
/// fewer than two runs measured it, or where all are equal.
std::vector<std::size_t> best_runs(std::string_view key, std::span<const Metrics> runs);

/// Aligned text for a terminal: one run.
std::string metrics_table(const Metrics& metrics);
/// Aligned text for a terminal: one column per run, named.
std::string comparison_table(std::span<const std::pair<std::string, Metrics>> runs);
/// The table of docs/metrics.md.
std::string metrics_markdown();

}  // namespace sgs::eval
