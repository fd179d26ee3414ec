// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/run/whole_run.h"

#include <utility>

#include "sgs/core/log.h"
#include "sgs/dataset/preloaded_source.h"
#include "sgs/mapfile/map_file.h"
#include "sgs/run/calibrate.h"
#include "sgs/run/input_doubts.h"
#include "sgs/run/refine.h"
#include "sgs/stream/address.h"

namespace sgs::run {
namespace {

bool calibrates_first(const InputSpec& spec) { return spec.calibration == kCalibrateFirst; }

/// Makes the input what the run proper is to see.
Status prepare(const RunConfig& config, const RunOptions& options, RunFolder& folder,
               RunObserver& observer, const std::stop_token& stop, InputSpec& spec, Input& input) {
  if (calibrates_first(spec)) {
    spec.calibration.clear();
    const auto watch = [&](const auto&, const auto*) { observer.on_calibration_frame(); };
    const Status calibrated =
        calibrate_first(spec, input, config.session, options.threads, folder, watch, stop);
    if (!calibrated) {
      folder.end(Stage::kInterrupted, 0, calibrated.error().message);
      return calibrated;
    }
  }
  if (options.preload) input.source = dataset::preload(std::move(input.source), stop);
  return {};
}

/// Refines the map of a run that is complete, in its folder.
Status refine_result(const RunConfig& config, const RunOptions& options, RunFolder& folder,
                     RunObserver& observer, const std::stop_token& stop, RunResult& result) {
  RefineOptions refining;
  refining.config = config.refine;
  refining.budget = budget_by_frames(config.refine, result.run);
  refining.threads = options.threads;
  auto refined = refine_run(result.run, refining, folder, observer, stop);
  if (!refined && refined.error().code == ErrorCode::kInterrupted) {
    // What there is is whole, but not what was asked for.
    RunState& state = result.run.state;
    state = {Stage::kInterrupted, "", 0, "stopped by request before the map was refined", true};
    result.run.metrics.state = state.word();
    folder.end(state.stage, result.run.frames.size(), state.reason);
    result.stopped = true;
    return {};
  }
  if (!refined) return tl::unexpected(refined.error());
  result.stopped = refined->refined.stopped;
  result.run = std::move(refined->run);
  return {};
}

}  // namespace

Status check_whole(const InputSpec& spec, const RunConfig& config, const RunOptions& options) {
  const bool once = stream::is_stream(spec.input);
  if (calibrates_first(spec) && once) {
    return fail(ErrorCode::kInvalidArgument, "a stream comes only once",
                "calibrate a recording of this camera, and name the file: --calibration FILE");
  }
  if (!spec.map.empty()) {
    SGS_ASSIGN_OR_RETURN(const auto map, mapfile::MapFile::open(spec.map));
    if (config.refine.steps_per_frame > 0) {
      return fail(ErrorCode::kInvalidArgument,
                  spec.extends_map
                      ? "a map of several sessions is not refined: only one recording is there"
                      : "a map that a camera finds itself in stays as it is",
                  "leave out refine.steps_per_frame (--preset quality)");
    }
  }
  if (config.refine.steps_per_frame <= 0) return {};
  constexpr const char* kAsked = "refine.steps_per_frame (--preset quality)";
  if (options.realtime) {
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{} is for recordings, not for runs at the sensor's rate", kAsked),
                "run live, then `sgs refine RUN`");
  }
  if (once) {
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{} goes through the frames twice; a stream comes once", kAsked),
                "keep the stream (--record FOLDER), then run that folder");
  }
  return {};
}

Result<Input> open_run_input(InputSpec spec, int threads, const std::stop_token& stop) {
  if (calibrates_first(spec)) spec.calibration.clear();
  return open_input(spec, threads, stop);
}

Result<WholeRun> run_whole(Input& input, InputSpec spec, const RunConfig& config,
                           const WholeRunOptions& options, RunFolder& folder, RunObserver& observer,
                           const std::stop_token& stop) {
  SGS_RETURN_IF_ERROR(check_whole(spec, config, options.run));
  for (const std::string& warning : input.info.warnings) log().warn("{}", warning);
  SGS_RETURN_IF_ERROR(prepare(config, options.run, folder, observer, stop, spec, input));
  SGS_ASSIGN_OR_RETURN(auto result,
                       execute(input, spec, config, options.run, folder, observer, stop));
  const bool complete = !result.stopped && result.input && !result.run.gaussians.empty();
  if (config.refine.steps_per_frame > 0 && complete) {
    SGS_RETURN_IF_ERROR(refine_result(config, options.run, folder, observer, stop, result));
  }
  ScoreOptions score = options.score;
  score.threads = options.run.threads;
  // What a stream has sent is gone.
  const bool pictures = options.pictures && !result.stopped && !stream::is_stream(spec.input);
  SGS_ASSIGN_OR_RETURN(auto scores, pictures ? score_run(result.run, score, observer, stop)
                                             : score_trajectory(result.run, score.association));
  if (!scores.no_recording.empty()) log().warn("{}", scores.no_recording);
  for (const std::string& doubt : doubts_about_units(result.run, scores.metrics)) {
    log().warn("{}", doubt);
  }
  return WholeRun{std::move(result), std::move(scores)};
}

}  // namespace sgs::run
