// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// How well the depth camera's offsets are found in sequences of the generator, where they are
// known, and what they are worth to tracking alone: one row per sequence.
//     sgs_calibration_benchmark [--set key=value] FOLDER:LEVEL:SEED...
// FOLDER is what `sgs synth SCENE:LEVEL FOLDER --seed SEED` wrote.

#include <fmt/format.h>
#include <spdlog/sinks/stdout_sinks.h>

#include <CLI/CLI.hpp>
#include <Eigen/Cholesky>
#include <cmath>

#include "sgs/core/log.h"
#include "sgs/dataset/calibrated_source.h"
#include "sgs/eval/trajectory_metrics.h"
#include "sgs/run/calibrate.h"
#include "sgs/runfolder/run_config.h"
#include "sgs/synthetic/sensor.h"

namespace {

using namespace sgs;

struct Job {
  std::string folder, level = "hard";
  std::uint64_t seed = 1;
};

Job parse(const std::string& text) {
  Job job;
  const auto first = text.find(':'), second = text.rfind(':');
  job.folder = text.substr(0, first);
  if (second != first) {
    job.level = text.substr(first + 1, second - first - 1);
    job.seed = std::stoull(text.substr(second + 1));
  }
  return job;
}

/// The offsets as the generator makes them, at the depths that each part of the image really sees:
/// the grid that fits them best.
struct Truth {
  Eigen::MatrixXd A;
  Eigen::VectorXd b, q;  // of the offsets, and of the inverse depths they are seen at

  void add(const RgbdFrame& frame, const synthetic::Sensor& sensor, const ImageGrid& grid) {
    constexpr int kStep = 8;
    if (A.size() == 0) {
      A.setIdentity(grid.size(), grid.size());
      A *= 1e-6;
      b.setZero(grid.size());
      q.setZero(grid.size());
    }
    for (int y = kStep / 2; y < frame.depth.height(); y += kStep) {
      const std::vector<float> offsets = sensor.inverse_depth_offsets(y, frame.depth.row(y));
      for (int x = kStep / 2; x < frame.depth.width(); x += kStep) {
        if (frame.depth(x, y) <= 0) continue;
        const double offset = double{offsets[static_cast<std::size_t>(x)]};
        const auto w = grid.at(x, y, frame.camera);
        for (std::size_t k = 0; k < 4; ++k) {
          b[w.node[k]] += w.weight[k] * offset;
          q[w.node[k]] += w.weight[k] / double{frame.depth(x, y)};
          for (std::size_t m = 0; m < 4; ++m) A(w.node[k], w.node[m]) += w.weight[k] * w.weight[m];
        }
      }
    }
  }
  /// But for a common factor of all depths, which nothing in a recording tells: the one that brings
  /// them nearest to what was found.
  std::vector<double> offsets_like(const DepthCalibration& found) const {
    const auto factors = A.ldlt();
    const Eigen::VectorXd offset = factors.solve(b), inverse_depth = factors.solve(q);
    double qq = 0, qe = 0;
    for (Eigen::Index k = 0; k < offset.size(); ++k) {
      const auto node = static_cast<std::size_t>(k);
      const double weight = 1 / (found.sigma_per_m[node] * found.sigma_per_m[node]);
      qq += weight * inverse_depth[k] * inverse_depth[k];
      qe += weight * inverse_depth[k] * (found.offset_per_m[node] - offset[k]);
    }
    const Eigen::VectorXd like = offset + (qq > 0 ? qe / qq : 0) * inverse_depth;
    return {like.data(), like.data() + like.size()};
  }
};

/// The path of a tracked input, as its frames come.
struct Path {
  std::vector<StampedPose> poses;

  void add(const RgbdFrame* frame, const tracker::TrackResult* result) {
    if (result != nullptr) poses.push_back({frame->timestamp_s, result->T_odom_camera});
  }
  eval::TrajectoryMetrics against(const Trajectory& truth) const {
    return eval::evaluate_trajectory(eval::to_estimates(Trajectory(poses)), truth);
  }
};

std::string in_words(const eval::TrajectoryMetrics& m) {
  return fmt::format("{:.2f} cm, scale {:.4f}", m.ate ? 100 * m.ate->rmse : NAN,
                     m.scale.value_or(NAN));
}

/// One row of the table.
Status judge(const Job& job, const slam::SessionConfig& config) {
  run::InputSpec spec;
  spec.input = job.folder;
  SGS_ASSIGN_OR_RETURN(auto input, run::open_input(spec, 2));
  const Trajectory true_path = input.source->ground_truth();
  const synthetic::Sensor sensor(synthetic::SensorModel::of_level(job.level, job.seed),
                                 input.source->camera(), job.seed);
  const ImageGrid grid{config.backend.calibration.columns, config.backend.calibration.rows};
  Truth truth;
  Path raw, corrected;
  const auto watch = [&](const auto& frame, const auto* result) {
    constexpr int kEvery = 30;
    raw.add(frame.get(), result);
    if (result != nullptr && frame->index % kEvery == 0) truth.add(*frame, sensor, grid);
  };
  SGS_ASSIGN_OR_RETURN(const auto e, run::calibrate(input, config, watch));
  const auto before = raw.against(true_path);
  const std::string name = job.folder.substr(job.folder.rfind('/') + 1);
  if (!e.why_not.empty()) {
    fmt::print("| {} | {} | {} |\n", name, e.why_not, in_words(before));
    return {};
  }
  const DepthCalibration& c = e.calibration;
  DepthCalibration ideal = c;
  ideal.offset_per_m = truth.offsets_like(c);
  const double mean = ideal.mean_offset_per_m(), found = c.mean_offset_per_m();
  const std::vector<double> area = c.grid.area();
  double shape_before = 0, shape_after = 0, covered = 0;
  for (std::size_t k = 0; k < area.size(); ++k) {
    const double shape = ideal.offset_per_m[k] - mean;
    const double off = c.offset_per_m[k] - ideal.offset_per_m[k];
    shape_before += area[k] * shape * shape;
    shape_after += area[k] * (off - found + mean) * (off - found + mean);
    covered += std::abs(off) <= 2 * c.sigma_per_m[k] ? 1.0 / static_cast<double>(area.size()) : 0;
  }
  SGS_ASSIGN_OR_RETURN(input, run::open_input(spec, 2));
  SGS_ASSIGN_OR_RETURN(input.source,
                       dataset::calibrated(std::move(input.source), c, "the estimate"));
  const auto follow = [&](const auto& frame, const auto* result) {
    corrected.add(frame.get(), result);
  };
  SGS_RETURN_IF_ERROR(run::track_only(*input.source, config, follow));
  const auto after = corrected.against(true_path);
  const Eigen::Vector2d shift = sensor.registration_shift();
  fmt::print(
      "| {} | {} | {:+.5f} | {:+.5f} ± {:.5f} | {:.5f} | {:.5f} | {:.0f} % | {:+.2f} {:+.2f} | "
      "{:+.2f} {:+.2f} | {} | {} |\n",
      name, e.keyframes, mean, found, c.mean_sigma_per_m, std::sqrt(shape_before),
      std::sqrt(shape_after), 100 * covered, shift.x(), shift.y(), c.shift_px.x(), c.shift_px.y(),
      in_words(before), in_words(after));
  std::fflush(stdout);
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Depth calibration against the generator's truth");
  std::vector<std::string> jobs, assignments;
  bool verbose = false;
  app.add_option("FOLDER:LEVEL:SEED", jobs)->required();
  app.add_option("--set", assignments, "key=value")->take_all()->allow_extra_args(false);
  app.add_flag("--verbose", verbose);
  CLI11_PARSE(app, argc, argv);
  log().set_level(verbose ? spdlog::level::debug : spdlog::level::warn);
  if (verbose) set_log_sinks({std::make_shared<spdlog::sinks::stderr_sink_st>()});
  run::InputSpec none;
  run::ConfigSources sources;
  sources.assignments = assignments;
  const auto config = run::resolve_config(sources, none);
  if (!config) return fmt::print(stderr, "{}\n", config.error().text()), 2;
  fmt::print(
      "| sequence | keyframes | mean /m | found | shape rms /m | left over | in 2 sigma | shift px "
      "| "
      "found | ATE before | after |\n|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const std::string& job : jobs) {
    if (const auto judged = judge(parse(job), config->session); !judged) {
      fmt::print(stderr, "{}: {}\n", job, judged.error().text());
      return 1;
    }
  }
  return 0;
}
