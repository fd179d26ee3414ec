// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Whole offline runs, map and all, of a tracker whose poses drift: what closing loops does to the
// map. Each run is saved as a folder for `sgs eval`.
//     sgs_drift_benchmark [--drift] [--bias] [--set key=value] -o FOLDER INPUT...
// INPUT may be synth:NAME:LEVEL@SEED.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <memory>

#include "injected_drift.h"
#include "sgs/core/log.h"
#include "sgs/eval/trajectory_metrics.h"
#include "sgs/runfolder/run.h"
#include "sgs/slam/session.h"
#include "tracking_input.h"

namespace {

using namespace sgs;

struct Options {
  benchmarks::InjectedDrift drift;
  std::string folder, calibration;
  int threads = 2;
};

double ate_cm(const Trajectory& poses, const Trajectory& truth) {
  const auto m = eval::evaluate_trajectory(eval::to_estimates(poses), truth);
  return m.ate ? 100 * m.ate->rmse : NAN;
}

Status feed_all(dataset::FrameSource& source, slam::Session& session) {
  Error error;
  for (;;) {
    auto frame = std::make_shared<RgbdFrame>();
    const auto read = source.next(*frame, error);
    if (read == dataset::FrameRead::kEnd) break;
    if (read == dataset::FrameRead::kOk) {
      session.feed(frame);
    } else {
      session.feed_bad(frame->index, frame->timestamp_s, error.message);
    }
  }
  session.finish();
  return {};
}

Status judge(const std::string& input_name, const slam::SessionConfig& config,
             const Options& options) {
  run::InputSpec spec = benchmarks::input_of(input_name);
  spec.calibration = options.calibration;
  SGS_ASSIGN_OR_RETURN(auto input, run::open_input(spec, options.threads));
  const PinholeCamera camera = input.source->camera();
  SGS_ASSIGN_OR_RETURN(auto tracker, tracker::make_tracker(config.tracker, camera, SE3{}));
  tracker = options.drift.onto(std::move(tracker), config.seed);
  slam::SessionOptions session_options;
  session_options.threads = options.threads;
  SGS_ASSIGN_OR_RETURN(auto session,
                       slam::Session::create(config, camera, session_options, std::move(tracker)));
  SGS_RETURN_IF_ERROR(feed_all(*input.source, *session));
  const run::Run run = run::run_of(*session, input, spec);
  const auto loops = session->loop_counts().value_or(loops::LoopCounts{});
  fmt::print("| {} | {} | {:.2f} | {:.2f} | {} | {} | {} | {} |\n",
             benchmarks::short_name(input_name), run.frames.size(), ate_cm(run.online, run.truth),
             ate_cm(run.trajectory, run.truth), loops.accepted, loops.re_estimated,
             loops.corrections, run.gaussians.size());
  std::fflush(stdout);
  return run::save_run(run, options.folder + "/" + benchmarks::short_name(input_name));
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Maps made with poses that drift");
  std::vector<std::string> inputs, assignments;
  Options options;
  app.add_option("INPUT", inputs)->required();
  app.add_option("-o,--out", options.folder, "Folder for the runs")->required();
  app.add_option("--set", assignments, "key=value")->take_all()->allow_extra_args(false);
  app.add_option("--calibration", options.calibration, "of the depth camera, for all inputs");
  options.drift.declare(app);
  app.add_option("--threads", options.threads);
  CLI11_PARSE(app, argc, argv);
  log().set_level(spdlog::level::warn);
  const char* header =
      "| sequence | frames | ATE online | final cm | loops | ways mended | corrections | Gaussians "
      "|\n|---|---|---|---|---|---|---|---|\n";
  return benchmarks::print_table(header, inputs, assignments,
                                 [&](const std::string& name, const slam::SessionConfig& config) {
                                   return judge(name, config, options);
                                 });
}
