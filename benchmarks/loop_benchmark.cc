// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// What closing loops does to recordings whose truth is known, with tracking alone: one row each.
//     sgs_loop_benchmark [--drift] [--bias] [--set key=value] INPUT...
// INPUT may be synth:NAME:LEVEL@SEED.

#include <fmt/format.h>
#include <spdlog/sinks/stdout_sinks.h>

#include <CLI/CLI.hpp>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "injected_drift.h"
#include "sgs/core/log.h"
#include "sgs/core/stopwatch.h"
#include "sgs/eval/trajectory_metrics.h"
#include "sgs/io/atomic_file.h"
#include "sgs/io/trajectory_io.h"
#include "sgs/loops/loop_closer.h"
#include "sgs/registration/view_distance.h"
#include "sgs/slam/loop_back_end.h"
#include "sgs/tracker/odometry.h"
#include "tracking_input.h"

namespace {

using namespace sgs;

struct Options {
  benchmarks::InjectedDrift drift;
  std::string calibration, trajectories;
};

double ate_cm(const std::vector<StampedPose>& poses, const Trajectory& truth) {
  const auto m = eval::evaluate_trajectory(eval::to_estimates(Trajectory(poses)), truth);
  return m.ate ? 100 * m.ate->rmse : NAN;
}

/// Mean of e^T Lambda e per direction, and how many edges it is of.
struct Nees {
  double sum = 0;
  int directions = 0, edges = 0;

  void add(const graph::Edge& edge, const SE3& T_from_to) {
    const Vector6d e = (edge.T_from_to.inverse() * T_from_to).log();
    sum += e.dot(edge.information * e);
    directions += graph::rank(edge.information);
    ++edges;
  }
  double mean() const { return directions > 0 ? sum / directions : NAN; }
};

/// Stretches of the way on which an older node's view is seen again, by the truth, and from how
/// many of them a loop to such a node was found.
struct Revisits {
  int stretches = 0, found = 0;
};

/// `seen_again[n]`: whether node n sees what a node of `config.min_gap_s` ago saw, which the camera
/// had left since; empty where truth is missing.
std::vector<bool> seen_again(const loops::PoseGraph& s, const Trajectory& truth,
                             const PinholeCamera& camera, const loops::LoopConfig& config) {
  std::vector<std::optional<SE3>> poses;
  for (int k = 0; k < s.size(); ++k) poses.push_back(truth.at(s.node(k).timestamp_s, 0.1));
  std::vector<bool> again(poses.size(), false);
  for (int m = 0; m < s.size(); ++m) {
    const auto& from = poses[static_cast<std::size_t>(m)];
    bool left = false;
    for (int n = m + 1; from && n < s.size(); ++n) {
      const auto& to = poses[static_cast<std::size_t>(n)];
      if (!to) continue;
      const double distance =
          registration::view_distance(camera, s.node(m).mean_depth_m, from->inverse() * *to);
      left = left || distance > config.left_distance;
      const bool long_ago = s.node(n).timestamp_s - s.node(m).timestamp_s >= config.min_gap_s;
      if (left && long_ago && distance < config.revisit_distance) {
        again[static_cast<std::size_t>(n)] = true;
      }
    }
  }
  return again;
}

/// A stretch that is interrupted for a node or two goes on; one of a single node is a glance.
Revisits revisits(const loops::PoseGraph& s, const std::vector<bool>& again) {
  constexpr int kInterruption = 2;
  Revisits out;
  for (int begin = 0, end = 0; begin < s.size(); begin = end + 1) {
    end = begin;
    if (!again[static_cast<std::size_t>(begin)]) continue;
    int nodes = 0;
    for (int k = begin; k < s.size() && k <= end + kInterruption + 1; ++k) {
      if (!again[static_cast<std::size_t>(k)]) continue;
      end = k;
      ++nodes;
    }
    if (nodes < 2) continue;
    ++out.stretches;
    const auto& loops = s.loops();
    const bool found = std::any_of(loops.begin(), loops.end(), [&](const graph::Edge& e) {
      return e.to >= begin && e.to <= end;
    });
    out.found += found ? 1 : 0;
    log().debug("nodes {} to {} ({:.1f} to {:.1f} s) see a place again: {}", begin, end,
                s.node(begin).timestamp_s, s.node(end).timestamp_s, found ? "found" : "missed");
  }
  return out;
}

/// The path as it was said and as it is at the end, for plots.
Status save_paths(const std::string& folder, const std::string& name,
                  const std::vector<StampedPose>& online,
                  const std::vector<StampedPose>& corrected) {
  if (folder.empty()) return {};
  SGS_RETURN_IF_ERROR(io::make_folder(folder));
  const std::string path = folder + "/" + name;
  SGS_RETURN_IF_ERROR(io::save_trajectory(path + "-online.txt", Trajectory(online)));
  return io::save_trajectory(path + "-final.txt", Trajectory(corrected));
}

std::vector<StampedPose> poses_of(const history::Path& path) {
  std::vector<StampedPose> out;
  for (std::size_t k = 0; k < path.size(); ++k) {
    out.push_back({path[k].timestamp_s, path[k].T_odom_camera});
  }
  return out;
}

/// One row of the table.
Status judge(const std::string& input_name, const slam::SessionConfig& config,
             const Options& options) {
  run::InputSpec spec = benchmarks::input_of(input_name);
  spec.calibration = options.calibration;
  SGS_ASSIGN_OR_RETURN(auto input, run::open_input(spec, 2));
  dataset::FrameSource& source = *input.source;
  const Trajectory truth = source.ground_truth();
  SGS_ASSIGN_OR_RETURN(auto tracker, tracker::make_tracker(config.tracker, source.camera(), SE3{}));
  tracker::Odometry odometry(options.drift.onto(std::move(tracker), config.seed));
  loops::LoopCloser closer(config.loops, slam::pair_config(config.tracker), config.seed,
                           std::make_shared<history::ViewStore>(config.history));
  std::vector<StampedPose> online;
  std::vector<double> track_ms;
  double closing_ms = 0, longest_ms = 0;
  int lost = 0;
  RgbdFrame frame;
  Error error;
  for (auto read = source.next(frame, error); read != dataset::FrameRead::kEnd;
       read = source.next(frame, error)) {
    if (read != dataset::FrameRead::kOk) continue;
    const double begin_s = thread_cpu_time_s();
    const auto result = odometry.track(frame, nullptr);
    const double tracked_s = thread_cpu_time_s();
    track_ms.push_back(1e3 * (tracked_s - begin_s));
    lost += result.status == tracker::TrackingStatus::kLost ? 1 : 0;
    online.push_back({frame.timestamp_s, result.T_odom_camera});
    if (!config.loops.enabled) continue;
    const auto correction = closer.add(frame, slam::tracked_frame(result), odometry.revision());
    const double ms = 1e3 * (thread_cpu_time_s() - tracked_s);
    closing_ms += ms;
    longest_ms = std::max(longest_ms, ms);
    if (!correction) continue;
    odometry.revise({*correction});
    log().debug("frame {}: {} loops, moves by {:.3f} m; error so far {:.2f} cm", frame.index,
                closer.pose_graph().loops().size(), correction->largest_translation_m(),
                ate_cm(poses_of(odometry.revision().path), truth));
  }
  // Edges against the truth.
  const loops::PoseGraph& s = closer.pose_graph();
  const auto true_pose = [&](int node) { return truth.at(s.node(node).timestamp_s, 0.1); };
  Nees loop_nees, way_nees;
  int wrong = 0;
  for (const graph::Edge& e : s.loops()) {
    const auto a = true_pose(e.from), b = true_pose(e.to);
    if (!a || !b) continue;
    const SE3 T = a->inverse() * *b;
    loop_nees.add(e, T);
    const SE3 off = e.T_from_to.inverse() * T;
    log().debug("loop {} - {}: off by {:.2f} cm, {:.2f} deg, rank {}", e.from, e.to,
                100 * off.t.norm(), off.angle() * 180 / std::numbers::pi,
                graph::rank(e.information));
    wrong += off.t.norm() > 0.1 || off.angle() > 5 * std::numbers::pi / 180 ? 1 : 0;
  }
  for (int k = 0; k + 1 < s.size(); ++k) {
    const auto a = true_pose(k), b = true_pose(k + 1);
    const auto way = s.tracked(k, k + 1);
    if (a && b) way_nees.add({k, k + 1, way.T, way.covariance.inverse(), false}, a->inverse() * *b);
  }
  const Revisits seen = revisits(s, seen_again(s, truth, source.camera(), config.loops));
  const auto p95 = [&](std::size_t begin, std::size_t end) {
    std::vector<double> part(track_ms.begin() + static_cast<std::ptrdiff_t>(begin),
                             track_ms.begin() + static_cast<std::ptrdiff_t>(end));
    if (part.empty()) return 0.0;
    std::sort(part.begin(), part.end());
    return part[part.size() * 95 / 100];
  };
  const std::vector<StampedPose> corrected = poses_of(odometry.revision().path);
  const loops::LoopCounts& c = closer.counts();
  fmt::print(
      "| {} | {} | {} | {:.2f} | {:.2f} | {} | {} / {} / {} / {} / {} | {} of {} | {} | {} | {} | "
      "{:.2f} | "
      "{:.2f} "
      "| "
      "{:.1f} / {:.1f} | {:.2f} | {:.0f} |\n",
      benchmarks::short_name(input_name), online.size(), lost, ate_cm(online, truth),
      ate_cm(poses_of(odometry.revision().path), truth), s.size(), c.compared, c.verified, c.gated,
      c.accepted, c.taken_back, seen.found, seen.stretches, wrong, c.re_estimated, c.corrections,
      loop_nees.mean(), way_nees.mean(), p95(0, track_ms.size() / 2),
      p95(track_ms.size() / 2, track_ms.size()),
      closing_ms / static_cast<double>(std::max<std::size_t>(1, online.size())), longest_ms);
  std::fflush(stdout);
  return save_paths(options.trajectories, benchmarks::short_name(input_name), online, corrected);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Loop closure with tracking alone");
  std::vector<std::string> inputs, assignments;
  Options options;
  bool verbose = false;
  app.add_option("INPUT", inputs)->required();
  app.add_option("--set", assignments, "key=value")->take_all()->allow_extra_args(false);
  app.add_option("--calibration", options.calibration, "of the depth camera, for all inputs");
  options.drift.declare(app);
  app.add_option("--trajectories", options.trajectories, "Folder for the paths, as TUM files");
  app.add_flag("--verbose", verbose);
  CLI11_PARSE(app, argc, argv);
  log().set_level(verbose ? spdlog::level::debug : spdlog::level::warn);
  if (verbose) set_log_sinks({std::make_shared<spdlog::sinks::stderr_sink_st>()});
  const char* header =
      "| sequence | frames | lost | ATE online | final cm | nodes | compared / verified / gated / "
      "accepted / taken back | revisits found | wrong | ways mended | corrections | NEES loops | "
      "way | tracking p95 "
      "first, second "
      "half ms | closing ms a frame | longest |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  return benchmarks::print_table(header, inputs, assignments,
                                 [&](const std::string& name, const slam::SessionConfig& config) {
                                   return judge(name, config, options);
                                 });
}
