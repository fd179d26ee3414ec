// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <memory>

#include "commands.h"
#include "interrupt.h"
#include "log_setup.h"
#include "play.h"
#include "preloaded_source.h"
#include "run_request.h"
#include "score.h"
#include "sgs/core/log.h"
#include "sgs/io/atomic_file.h"
#include "sgs/io/ply.h"
#include "sgs/io/trajectory_io.h"
#include "timings.h"
#include "version.h"

namespace sgs::app {
namespace {

namespace fs = std::filesystem;

/// What the run itself can measure; scores are added later.
eval::Metrics run_metrics(const RunRequest& request, const slam::SessionConfig& config,
                          const slam::Session& session, const RunClock& clock,
                          std::size_t gaussians) {
  constexpr std::int64_t kBytesPerGaussian = sizeof(map::Gaussian);
  eval::Metrics m;
  m.gaussians = static_cast<std::int64_t>(gaussians);
  m.map_bytes = kBytesPerGaussian * static_cast<std::int64_t>(gaussians);
  m.keyframes = static_cast<std::int64_t>(session.keyframes().size());
  m.mapping_iterations = session.iterations();
  const auto fed = static_cast<double>(session.records().size());
  const double system_s = clock.wall_s - clock.starved_s;
  if (fed > 1 && system_s > 0) m.fps_system = fed / system_s;
  if (fed > 1 && clock.wall_s > 0) m.fps_wall = fed / clock.wall_s;
  const StageTimes times = session.times();
  if (const auto it = times.stages().find("map/iteration"); it != times.stages().end()) {
    m.map_iteration_ms_p50 = quantile(it->second, 0.5);
  }
  if (const auto rss = peak_rss_bytes(); rss > 0) m.peak_rss_bytes = rss;
  if (request.realtime) m.frames_dropped = clock.frames_dropped;
  m.seed = static_cast<std::int64_t>(config.seed);
  m.threads = request.threads;
  m.preset = to_string(config.preset);
  m.tracker = to_string(config.tracker.type);
  m.version = std::string(kVersion);
  return m;
}

/// Files that need nothing but the session; written before any score is computed.
void save_session(const slam::Session& session, const FinishedRun& run, RunFolder& folder) {
  session.save([&](const std::string& name, const slam::Session::FileWriter& write) {
    folder.save(name, write);
  });
  folder.save("groundtruth.txt",
              [&](const fs::path& path) { return io::save_trajectory(path, run.truth); });
  folder.save_text("timings.json", run.timings_json);
}

/// Lost at the end, or for more than half of the frames: the result is not what was asked for.
bool tracking_was_lost(const slam::Session& session) {
  std::int64_t lost = 0, all = 0;
  bool last_lost = false;
  for (const slam::FrameRecord& record : session.records()) {
    if (record.bad) continue;
    last_lost = record.status == tracker::TrackingStatus::kLost;
    lost += last_lost ? 1 : 0;
    ++all;
  }
  return all == 0 || last_lost || 2 * lost > all;
}

int report_failures(const RunFolder& folder) {
  for (const Error& error : folder.failures()) report(error);
  if (!folder.rescued_to().empty()) {
    fmt::print(stderr, "sgs: what did not fit there was kept in {}\n",
               folder.rescued_to().string());
  }
  return folder.failures().empty() ? kExitDone : kExitFailed;
}

/// Everything between an open input and the exit code.
Result<int> run_sequence(const RunRequest& request, const slam::SessionConfig& config, Input& input,
                         RunFolder& folder) {
  FinishedRun run;
  run.input = request.input;
  run.config = config;
  run.config_toml = effective_config(request.input, config);
  run.name = input.info.name;
  run.truth = input.source->ground_truth();
  folder.save_text("config.toml", run.config_toml);

  slam::SessionOptions session_options;
  session_options.threads = request.threads;
  session_options.live = request.realtime;
  SGS_ASSIGN_OR_RETURN(auto session,
                       slam::Session::create(config, input.source->camera(), session_options));
  std::optional<dataset::TumSequenceWriter> recorder;
  if (!request.record.empty()) {
    SGS_ASSIGN_OR_RETURN(
        recorder, dataset::TumSequenceWriter::create(request.record, input.source->camera()));
  }
  SGS_ASSIGN_OR_RETURN(const auto viewer, ViewerLink::open(request.viewer, input, config));
  PlayOptions play_options{request.realtime, request.quiet, recorder ? &*recorder : nullptr,
                           viewer.get()};
  const auto clock = play(input, *session, play_options);
  if (viewer) viewer->finish(*session);
  const bool stopped_early = interrupted();

  run.trajectory = session->trajectory();
  run.keyframes = session->keyframe_trajectory();
  run.frames_csv = slam::frames_csv(session->records());
  const StageTimes times = session->times();
  run.timings_json = timings_json(times);
  if (!request.trace.empty()) {
    SGS_RETURN_IF_ERROR(io::write_file(request.trace, chrome_trace(times)));
  }
  run.frames = clock ? clock->frames_in : static_cast<std::int64_t>(session->records().size());
  if (const auto snapshot = session->snapshot()) run.gaussians = snapshot->gaussians;
  save_session(*session, run, folder);
  // What is scored is what was written, to the last bit: `sgs eval` finds the same numbers.
  if (auto written = io::load_splats(folder.path() / "map.ply")) {
    run.gaussians = std::move(*written);
  }
  if (auto written = io::load_trajectory(folder.path() / "trajectory.txt")) {
    run.trajectory = std::move(written->trajectory);
  }

  ScoreOptions score;
  score.lpips_weights = request.lpips_weights;
  score.lpips_stride = request.lpips_stride;
  score.threads = request.threads;
  score.quiet = request.quiet;
  score.rendering = !request.no_eval && !stopped_early;
  SGS_ASSIGN_OR_RETURN(const auto metrics,
                       score_run(run, score,
                                 run_metrics(request, config, *session, clock.value_or(RunClock{}),
                                             run.gaussians.size()),
                                 folder));
  fmt::print("{}", request.json ? eval::to_json(metrics) + "\n" : eval::metrics_table(metrics));
  if (!request.json) {
    fmt::print("\nrun     {}\nreport  {}\n", folder.path().string(),
               (folder.path() / "report.html").string());
  }
  if (viewer) viewer->close(eval::to_json(metrics), folder.path());
  const int failed = report_failures(folder);
  if (!clock) return tl::unexpected(clock.error());
  if (failed != kExitDone) return failed;
  if (stopped_early) return kExitInterrupted;
  if (tracking_was_lost(*session)) {
    fmt::print(stderr, "sgs: tracking was lost; see frames.csv and the report\n");
    return kExitLost;
  }
  return kExitDone;
}

int run_command(RunRequest request) {
  return_freed_images();
  const auto config = resolve_config(request);
  if (!config) return report(config.error());
  if (request.input.input.empty()) {
    return report({ErrorCode::kInvalidArgument, "no input given",
                   "give a sequence folder or synth:NAME (see `sgs info --scenes`)"});
  }
  auto input = open_input(request.input, request.threads);
  if (!input) return report(input.error());
  auto folder = RunFolder::create(request.output, input->info.name);
  if (!folder) return report(folder.error());
  setup_logging(folder->path() / "log.txt", request.quiet);
  for (const std::string& warning : input->info.warnings) log().warn("{}", warning);
  if (request.preload) input->source = preload(std::move(input->source));
  const auto code = run_sequence(request, *config, *input, *folder);
  return code ? *code : report(code.error());
}

}  // namespace

void add_run(CLI::App& app, Action& action) {
  auto request = std::make_shared<RunRequest>();
  request->preset = "default";
  auto* sub = app.add_subcommand("run", "SLAM on a sequence: trajectory, Gaussian map, scores");
  sub->add_option("INPUT", request->input.input, "Sequence folder, or synth:NAME[:LEVEL]");
  sub->add_option("-o,--output", request->output, "Run folder (default runs/TIME-NAME)");
  sub->add_option("--preset", request->preset, "default (ours) or paper");
  sub->add_option("--config", request->config_file, "TOML file, e.g. a run's config.toml");
  sub->add_option("--tracker", request->tracker, "spectral, paper, gicp, orb or cvm");
  sub->add_option("--set", request->assignments, "key=value, see `sgs info --config`")
      ->take_all()
      ->allow_extra_args(false);
  sub->add_option("--frames", request->input.frames, "a:b, frames a to b-1 of the sequence");
  sub->add_option("--camera", request->input.camera, "fx,fy,cx,cy[,k1,k2,p1,p2,k3]");
  sub->add_option("--depth-scale", request->input.depth_scale, "Raw depth units per metre")
      ->check(CLI::PositiveNumber);
  sub->add_option("--trajectory", request->input.trajectory,
                  "Synthetic input: fly along this TUM trajectory");
  sub->add_option("--synth-seed", request->input.synth_seed, "Synthetic input: scene and noise");
  sub->add_option("--threads", request->threads, "Threads")->check(CLI::Range(1, 256));
  sub->add_option("--seed", request->seed, "Seed of the mapper's random choices");
  sub->add_option("--lpips-weights", request->lpips_weights, "LPIPS-Alex v0.1 weights");
  sub->add_option("--lpips-stride", request->lpips_stride, "LPIPS on every n-th frame")
      ->check(CLI::PositiveNumber);
  sub->add_option("--record", request->record, "Keep the input in this folder (TUM layout)");
  request->viewer.add_run_options(*sub, request->input.input);
  sub->add_option("--trace", request->trace,
                  "Write a time line of both threads to this file (Chrome trace format)");
  sub->add_flag("--preload", request->preload,
                "Decode all frames before the clock starts (takes 2 MB per frame of 640x480)");
  sub->add_flag("--realtime", request->realtime, "Frames at the sensor's rate, late ones dropped");
  sub->add_flag("--no-eval", request->no_eval, "Skip the rendering scores");
  sub->add_flag("--quiet", request->quiet, "No progress, no warnings on the terminal");
  sub->add_flag("--json", request->json, "Print the metrics as JSON");
  sub->callback([request, &action] { action = [request] { return run_command(*request); }; });
}

}  // namespace sgs::app
