// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/run/refine.h"

#include <fmt/format.h>

#include <memory>

#include "commands.h"
#include "input_options.h"
#include "interrupt.h"
#include "log_setup.h"
#include "progress.h"
#include "scoring.h"
#include "sgs/core/log.h"
#include "sgs/core/print.h"
#include "sgs/io/ply.h"
#include "sgs/io/trajectory_io.h"
#include "sgs/report/save_scores.h"
#include "sgs/run/process_memory.h"
#include "sgs/run/recorded_run.h"
#include "sgs/runfolder/run_config.h"
#include "sgs/runfolder/run_files.h"

namespace sgs::app {
namespace {

namespace fs = std::filesystem;

struct RefineCommand {
  run::InputSpec input;  // source: the run folder, or with --map a recording
  std::vector<std::string> assignments;
  std::string map, poses, output;
  double minutes = 0;
  std::int64_t steps = 0;
  run::RefineOptions options;
  run::ScoreOptions score;
  bool no_eval = false, quiet = false, json = false;
  bool by_frames = false;  ///< neither minutes nor steps were given
};

/// A run that ours or another program made.
Result<run::Run> load(const RefineCommand& command) {
  if (!command.map.empty()) {
    run::InputSpec spec = command.input;
    SGS_ASSIGN_OR_RETURN(const auto config, run::resolve_config({}, spec));
    SGS_ASSIGN_OR_RETURN(auto map, io::load_splats(command.map));
    SGS_ASSIGN_OR_RETURN(auto poses, io::load_trajectory(command.poses));
    return run::run_of_map(spec, std::move(map), std::move(poses.trajectory), config,
                           command.options.threads);
  }
  const fs::path folder = command.input.input;
  SGS_ASSIGN_OR_RETURN(auto run, run::load_run(folder, run::kAllParts));
  if (run.state.held) {
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("the run in {} is still going on", folder.string()), "wait for it");
  }
  return run::with_its_recording(std::move(run), folder);
}

Status check_output(const fs::path& output, const RefineCommand& command) {
  std::error_code none;
  if (!fs::equivalent(output, command.input.input, none)) return {};
  return fail(ErrorCode::kInvalidArgument,
              fmt::format("{} is what is to be refined", output.string()),
              "name another folder: the run is kept as it is");
}

/// Says how the map gets better, a line for each evaluation.
class RefineObserver : public run::RunObserver {
 public:
  RefineObserver(std::int64_t frames, bool quiet)
      : reading_("frames read", frames, quiet), quiet_(quiet) {}
  void on_frames_read(std::int64_t) override { reading_.step(""); }
  void on_evaluation(const refine::Evaluation& now) override;

 private:
  Progress reading_;
  bool quiet_;
};

std::string line_of(const refine::Evaluation& now) {
  return fmt::format(
      "{:>3.0f} %  {:>7} steps  {:>7} Gaussians  PSNR {} {:.2f} dB, exposed {:.2f} dB{}",
      100 * std::min(1.0, now.share), now.steps, now.gaussians,
      now.heldout ? "held out" : "training", now.psnr_db, now.psnr_exposed_db,
      now.best ? "  *" : "");
}

void RefineObserver::on_evaluation(const refine::Evaluation& now) {
  if (now.steps == 0) reading_.finish();
  if (!quiet_) say("{}\n", line_of(now));
}

/// The pictures of the run that was refined, for the report's sliders.
void keep_before(const std::string& source, run::Scores& scores) {
  if (!scores.rendering) return;
  std::vector<eval::FramePictures> before = run::load_pictures(source);
  for (eval::FramePictures& now : scores.rendering->pictures) {
    for (eval::FramePictures& then : before) {
      if (then.index == now.index) now.before = std::move(then.rendering);
    }
  }
}

void print_summary(const run::RefinedRun& out) {
  const refine::Refined& r = out.refined;
  const char* judge = r.heldout ? "held out" : "training (nothing is held out)";
  say("sgs: PSNR {} {:.2f} -> {:.2f} dB (exposed as the frames around: {:.2f}) after {} steps on "
      "{} frames, {} judging; {} -> {} "
      "Gaussians{}\n",
      judge, r.start.psnr_db, r.best.psnr_db, r.best.psnr_exposed_db, r.last.steps, out.frames_used,
      out.frames_heldout, r.start.gaussians, r.best.gaussians,
      r.exhausted ? "; ended early: nothing improved any more" : "");
  if (r.best.steps == 0) say("sgs: nothing became better: the map is the one it started from\n");
}

/// refine.KEY=VALUE, as everywhere.
Status set_parameters(RefineCommand& command) {
  ParameterList list;
  list.add_group("refine", command.options.config);
  for (const std::string& assignment : command.assignments) {
    SGS_RETURN_IF_ERROR(list.set_assignment(assignment));
  }
  return {};
}

Result<int> refine_command(const RefineCommand& command) {
  SGS_ASSIGN_OR_RETURN(const auto run, load(command));
  run::RefineOptions options = command.options;
  if (command.by_frames && options.config.steps_per_frame > 0) {
    options.budget = run::budget_by_frames(options.config, run);
  }
  const fs::path output =
      command.output.empty()
          ? run::refined_folder_of(command.map.empty() ? command.input.input : command.map)
          : fs::path(command.output);
  SGS_RETURN_IF_ERROR(check_output(output, command));
  SGS_ASSIGN_OR_RETURN(auto folder, run::RunFolder::create(output));
  setup_logging(folder.path() / run::files::kLog, command.quiet);
  RefineObserver observer(run.frames_total, command.quiet);
  const auto out = run::refine_run(run, options, folder, observer, stop_token());
  if (!out) {
    folder.end(run::Stage::kInterrupted, 0, out.error().message);
    return tl::unexpected(out.error());
  }
  if (!command.quiet) print_summary(*out);
  run::save_refine_parameters(command.input.input, options, folder);
  SGS_ASSIGN_OR_RETURN(auto scores,
                       command.no_eval || out->refined.stopped
                           ? run::score_trajectory(out->run, command.score.association)
                           : score_with_progress(out->run, command.score, command.quiet));
  keep_before(command.input.input, scores);
  report::save_scores(out->run, scores, folder);
  if (command.json) {
    print("{}\n", eval::to_json(scores.metrics));
  } else {
    print("{}\nrun     {}\nreport  {}\n", eval::metrics_table(scores.metrics),
          folder.path().string(), (folder.path() / run::files::kReport).string());
  }
  const int failed = report_failures(folder);
  if (failed != kExitDone) return failed;
  return out->refined.stopped ? kExitInterrupted : kExitDone;
}

int run_refine(RefineCommand command) {
  if (!command.map.empty() && command.poses.empty()) {
    return report({ErrorCode::kInvalidArgument, "--map needs --poses",
                   "give a TUM file with the poses of the recording's frames in the map's world"});
  }
  if (const Status set = set_parameters(command); !set) return report(set.error());
  run::return_freed_images();
  setup_logging({}, command.quiet);
  command.options.budget = {command.steps, 60 * command.minutes};
  if (command.steps > 0) command.options.budget.seconds = 0;
  command.score.threads = command.options.threads;
  const auto code = refine_command(command);
  return code ? *code : report(code.error());
}

}  // namespace

void add_refine(CLI::App& app, Action& action) {
  constexpr double kDefaultMinutes = 3;
  auto command = std::make_shared<RefineCommand>();
  command->minutes = kDefaultMinutes;
  auto* sub = app.add_subcommand(
      "refine", "Learn the map of a finished run on, to the quality that its recording holds");
  sub->add_option("RUN", command->input.input, "Run folder; with --map: the recording")->required();
  auto* minutes =
      sub->add_option("--minutes", command->minutes, "How long; 0 only writes and scores")
          ->check(CLI::Range(0.0, 10080.0))
          ->capture_default_str();
  auto* steps =
      sub->add_option("--steps", command->steps,
                      "So many steps instead: the same bits on any number of threads (default: as "
                      "refine.steps_per_frame says, where that is set)")
          ->check(CLI::Range(std::int64_t{1}, std::int64_t{100'000'000}))
          ->excludes(minutes);
  sub->add_option("-o,--output", command->output, "Run folder to make (default RUN-refined)");
  sub->add_option("--map", command->map, "Map of another program (splat PLY)");
  sub->add_option("--poses", command->poses,
                  "With --map: TUM file, camera to world of that map, one row per colour image");
  sub->add_option("--set", command->assignments, "key=value, e.g. refine.max_gaussians=2e5")
      ->take_all()
      ->allow_extra_args(false);
  add_recording_options(*sub, command->input);
  add_score_options(*sub, command->score);
  sub->add_option("--threads", command->options.threads, "Threads")->check(CLI::Range(1, 256));
  sub->add_flag("--no-eval", command->no_eval, "Skip the rendering scores");
  sub->add_flag("--quiet", command->quiet, "No progress");
  sub->add_flag("--json", command->json, "Print the metrics as JSON");
  sub->callback([command, minutes, steps, &action] {
    command->by_frames = minutes->count() == 0 && steps->count() == 0;
    action = [command] { return run_refine(*command); };
  });
}

}  // namespace sgs::app
