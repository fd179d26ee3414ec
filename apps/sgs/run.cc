// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <array>
#include <memory>
#include <utility>

#include "commands.h"
#include "input_options.h"
#include "interrupt.h"
#include "log_setup.h"
#include "robot_link.h"
#include "scoring.h"
#include "sgs/core/log.h"
#include "sgs/core/print.h"
#include "sgs/report/save_scores.h"
#include "sgs/run/process_memory.h"
#include "sgs/run/whole_run.h"
#include "sgs/runfolder/resume.h"
#include "sgs/runfolder/run_config.h"
#include "sgs/runfolder/run_files.h"
#include "sgs/stream/address.h"
#include "terminal_observer.h"
#include "viewer_link.h"

namespace sgs::app {
namespace {

/// What `sgs run` was asked to do, as given on the command line.
struct RunCommand {
  run::InputSpec input;
  run::ConfigSources config;
  run::RunOptions options;
  run::ScoreOptions score;
  std::string output;
  std::string resume;    ///< folder of a run to go on with
  std::string extended;  ///< map to go on with
  bool no_eval = false, quiet = false, json = false;
  ViewerRequest viewer;
  RobotRequest robot;
};

void print_result(const RunCommand& command, const eval::Metrics& metrics,
                  const std::filesystem::path& folder) {
  if (command.json) {
    print("{}\n", eval::to_json(metrics));
    return;
  }
  print("{}\nrun     {}\nreport  {}\n", eval::metrics_table(metrics), folder.string(),
        (folder / run::files::kReport).string());
}

/// What the run came to, in words where it came to little.
int exit_code_of(const run::WholeRun& whole, const run::RunFolder& folder) {
  const run::RunResult& result = whole.result;
  const int failed = report_failures(folder);
  if (!result.input) return report(result.input.error());
  if (failed != kExitDone) return failed;
  // A viewer that was kept open ends with Ctrl-C, too: that is no interruption of the run.
  const auto& rendering = whole.scores.rendering;
  if (result.stopped || (rendering && rendering->cancelled)) return kExitInterrupted;
  if (!result.not_found.empty()) {
    say("sgs: {}\n", result.not_found);
    return kExitLost;
  }
  if (!result.too_few.empty()) {
    say("sgs: {}\n", result.too_few);
    return kExitLost;
  }
  if (result.lost) {
    say("sgs: tracking was lost; see frames.csv and the report\n");
    return kExitLost;
  }
  return kExitDone;
}

/// What came of a run, and what is to follow it.
struct Ending {
  int exit_code = 0;
  std::optional<ViewerRequest> again;  ///< start again, for these clients
};

/// Whether a run can be followed by another one of the same input.
bool can_start_again(const RunCommand& command) {
  const auto address = stream::parse_address(command.input.input);
  const bool used_up = address && address->path == "-";
  return !used_up && command.resume.empty();
}

/// Everything between an open input and the exit code.
Result<Ending> run_input(const RunCommand& command, const run::RunConfig& config, run::Input& input,
                         run::RunFolder& folder) {
  SGS_ASSIGN_OR_RETURN(const auto viewer,
                       ViewerLink::open(command.viewer, input, command.input, config.session,
                                        can_start_again(command)));
  SGS_ASSIGN_OR_RETURN(const auto robot,
                       RobotLink::open(command.robot, input, command.options.realtime));
  TerminalObserver observer(input.source->size(), command.quiet, viewer.get(), robot.get());
  run::WholeRunOptions options{command.options, command.score, !command.no_eval};
  if (viewer) options.run.enough = viewer->enough();
  SGS_ASSIGN_OR_RETURN(const auto whole, run::run_whole(input, command.input, config, options,
                                                        folder, observer, stop_token()));
  observer.finish();
  report::save_scores(whole.result.run, whole.scores, folder);
  print_result(command, whole.scores.metrics, folder.path());
  Ending ending;
  const auto& recording = whole.result.recording;
  if (viewer && viewer->close(whole.scores.metrics, folder.path(), recording)) {
    ending.again = viewer->same_address(command.viewer);
  }
  ending.exit_code = exit_code_of(whole, folder);
  return ending;
}

Ending run_and_report(const RunCommand& command, const run::RunConfig& config, run::Input& input,
                      run::RunFolder& folder) {
  auto ending = run_input(command, config, input, folder);
  log().flush();
  return ending ? std::move(*ending) : Ending{report(ending.error()), {}};
}

/// Options that decide what a run computes, and where: not to be given again with --resume.
constexpr std::array<const char*, 25> kFixedByRun = {
    "INPUT",         "--output",     "--preset",      "--config",      "--set",
    "--tracker",     "--frames",     "--camera",      "--depth-scale", "--max-width",
    "--topics",      "--extrinsics", "--truth-topic", "--trajectory",  "--synth-seed",
    "--calibration", "--seed",       "--record",      "--preload",     "--realtime",
    "--poses",       "--wait",       "--stamps",      "--localize",    "--continue"};

/// Goes on with a run: everything is as it was, but for how it is watched and scored.
int resume_command(RunCommand command) {
  auto folder = run::RunFolder::resume(command.resume);
  if (!folder) return report(folder.error());
  auto point = run::load_resume_point(command.resume);
  if (!point) return report(point.error());
  command.input = point->saved.input;
  const run::RunConfig config = point->saved.config;
  command.options.resume = std::move(*point);
  auto input = run::open_input(command.input, command.options.threads, stop_token());
  if (!input) return report(input.error());
  setup_logging(folder->path() / run::files::kLog, command.quiet, LogStart::kAppend);
  if (command.options.resume->checkpoint.empty()) {
    log().warn("{} has no checkpoint that it could go on from: it begins again",
               folder->path().string());
  }
  return run_and_report(command, config, *input, *folder).exit_code;
}

/// Whether a run into `output` would take away the map that it begins with.
bool replaces_map(const std::string& map, const std::filesystem::path& output) {
  namespace fs = std::filesystem;
  std::error_code unreadable;
  const fs::path given =
      fs::is_directory(map, unreadable) ? fs::path(map) / run::files::kLastingMap : fs::path(map);
  return !map.empty() && !output.empty() &&
         fs::equivalent(output / run::files::kLastingMap, given, unreadable);
}

/// A camera sets the pace, unless every frame of it is wanted.
bool at_the_cameras_rate(const std::string& input) {
  const auto address = stream::parse_address(input);
  return address && address->camera && !address->camera->every_frame;
}

/// One run of the input from its beginning.
Ending run_once(const RunCommand& command, const run::RunConfig& config) {
  const auto failed = [](const Error& error) { return Ending{report(error), {}}; };
  // There is no folder yet, and somebody has to say what is waited for.
  if (stream::is_stream(command.input.input)) setup_logging({}, command.quiet);
  auto input = run::open_run_input(command.input, command.options.threads, stop_token());
  if (!input) return failed(input.error());
  auto folder = command.output.empty() ? run::RunFolder::create_below("runs", input->info.name)
                                       : run::RunFolder::create(command.output);
  if (!folder) return failed(folder.error());
  run::point_latest_to("runs", folder->path());
  setup_logging(folder->path() / run::files::kLog, command.quiet);
  return run_and_report(command, config, *input, *folder);
}

/// The command for the run after the first `count` ones: what they wrote stays.
RunCommand next_command(const RunCommand& first, int count, ViewerRequest viewer) {
  RunCommand next = first;
  for (std::string* path : {&next.output, &next.options.record, &next.options.trace}) {
    if (path->empty()) continue;
    const std::filesystem::path given(*path);
    const auto folder = given.has_filename() ? given : given.parent_path();
    const auto name =
        fmt::format("{}-{}{}", folder.stem().string(), count + 1, folder.extension().string());
    *path = (folder.parent_path() / name).string();
  }
  next.viewer = std::move(viewer);
  return next;
}

int run_command(RunCommand command) {
  run::return_freed_images(command.options.preload);
  if (!command.resume.empty()) return resume_command(std::move(command));
  if (!command.extended.empty()) {
    command.input.map = command.extended;
    command.input.extends_map = true;
  }
  command.options.realtime |= at_the_cameras_rate(command.input.input);
  const auto config = run::resolve_config(command.config, command.input);
  if (!config) return report(config.error());
  if (command.input.input.empty()) {
    return report({ErrorCode::kInvalidArgument, "no input given",
                   "give a sequence folder or synth:NAME (see `sgs info --scenes`)"});
  }
  if (const auto can = run::check_whole(command.input, *config, command.options); !can) {
    return report(can.error());
  }
  if (replaces_map(command.input.map, command.output)) {
    return report({ErrorCode::kInvalidArgument,
                   fmt::format("the run would replace the map in {} that it is to find itself in",
                               command.output),
                   "give another folder: -o FOLDER"});
  }
  Ending ending = run_once(command, *config);
  for (int count = 1; ending.again && !interrupted(); ++count) {
    say("sgs: starts again\n");
    ending = run_once(next_command(command, count, std::move(*ending.again)), *config);
  }
  return ending.exit_code;
}

}  // namespace

void add_run(CLI::App& app, Action& action) {
  auto command = std::make_shared<RunCommand>();
  auto* sub = app.add_subcommand("run", "SLAM on a sequence: trajectory, Gaussian map, scores");
  add_input_argument(
      *sub, command->input,
      "Sequence folder, bag (or the files of one), an Azure Kinect's .mkv, synth:NAME[:LEVEL], "
      "live:tcp://127.0.0.1:PORT, or camera: (docs/cameras.md)");
  sub->add_option("-o,--output", command->output, "Run folder (default runs/TIME-NAME)");
  auto* resume = sub->add_option("--resume", command->resume,
                                 "Go on with the run of this folder, which was killed or stopped: "
                                 "from its last checkpoint, to the same result to the bit");
  sub->add_option("--preset", command->config.preset,
                  "default (ours), paper, or quality (slow, offline)");
  add_tracking_options(*sub, command->input, command->config);
  sub->add_option("--calibration", command->input.calibration,
                  "Correct the depths by this file of `sgs calibrate`; auto: calibrate first");
  sub->add_option("--localize", command->input.map,
                  "Find the camera in this map.sgsmap (or run folder) of an earlier run and track "
                  "it there: poses are in that map's world, and nothing of it changes");
  auto* localize = sub->get_option("--localize");
  sub->add_option("--continue", command->extended,
                  "Find the camera in this map.sgsmap (or run folder) of an earlier run and go on "
                  "with it: the run leaves a map of all sessions, the file itself is only read")
      ->excludes(localize);
  sub->add_option("--threads", command->options.threads, "Threads")->check(CLI::Range(1, 256));
  sub->add_option("--seed", command->config.seed, "Seed of the mapper's random choices");
  add_score_options(*sub, command->score);
  sub->add_option("--record", command->options.record,
                  "Keep the input in this folder (TUM layout)");
  command->viewer.add_run_options(*sub, command->input.input);
  command->robot.add_run_options(*sub);
  sub->add_option("--trace", command->options.trace,
                  "Write a time line of both threads to this file (Chrome trace format)");
  sub->add_flag("--preload", command->options.preload,
                "Decode all frames before the clock starts (takes 2 MB per frame of 640x480)");
  sub->add_option("--wait", command->input.wait_s,
                  "Stream: end when nobody has sent a frame for so many seconds; 0 = never")
      ->check(CLI::Range(0.0, 1e9))
      ->capture_default_str();
  sub->add_flag("--realtime", command->options.realtime,
                "Frames at the sensor's rate, late ones dropped");
  sub->add_option("--checkpoint", command->options.checkpoint_s,
                  "Keep the map at least every so many seconds, should the run be killed; 0: only "
                  "at the end (default 10)")
      ->check(CLI::Range(0.0, 86400.0));
  sub->add_flag("--no-eval", command->no_eval, "Skip the rendering scores");
  sub->add_flag("--quiet", command->quiet, "No progress, no warnings on the terminal");
  sub->add_flag("--json", command->json, "Print the metrics as JSON");
  sub->callback([command, sub, resume, &action] {
    for (const char* option : kFixedByRun) {
      if (resume->count() == 0 || sub->get_option(option)->count() == 0) continue;
      throw CLI::ExcludesError(resume->get_name(), option);
    }
    action = [command] { return run_command(*command); };
  });
}

}  // namespace sgs::app
