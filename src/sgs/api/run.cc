// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/api/run.h"

#include "sgs/api/internal/access.h"
#include "sgs/api/internal/guard.h"
#include "sgs/api/internal/metrics.h"
#include "sgs/api/internal/stop_token.h"
#include "sgs/core/log.h"
#include "sgs/report/save_scores.h"
#include "sgs/run/execute.h"

namespace sgs::api {
namespace {

run::Spectator telling(const std::function<void(std::int64_t)>& progress) {
  run::Spectator spectator;
  spectator.after_frame = [&progress, frames = std::int64_t{0}](auto&, auto&, auto&) mutable {
    ++frames;
    if (progress) progress(frames);
  };
  return spectator;
}

Result<RunSummary> run_input(run::Input& input, const run::InputSpec& spec, const Config& config,
                             const RunOptions& options,
                             const std::function<void(std::int64_t)>& progress,
                             const std::stop_token& stop) {
  run::RunOptions run_options;
  run_options.threads = options.threads;
  run_options.realtime = options.realtime;
  run_options.record = options.record;
  SGS_ASSIGN_OR_RETURN(auto folder, options.output.empty()
                                        ? run::RunFolder::create_below("runs", input.info.name)
                                        : run::RunFolder::create(options.output));
  SGS_ASSIGN_OR_RETURN(const auto outcome, run::execute(input, spec, config.modules(), run_options,
                                                        folder, telling(progress), stop));
  run::ScoreOptions score;
  score.threads = options.threads;
  score.lpips_weights = options.lpips_weights;
  const bool pictures = options.pictures && !outcome.stopped;
  SGS_ASSIGN_OR_RETURN(const auto scores,
                       pictures ? run::score_run(outcome.run, score, {}, stop)
                                : run::score_trajectory(outcome.run, score.association));
  report::save_scores(outcome.run, scores, folder);
  if (!outcome.input) return tl::unexpected(outcome.input.error());
  if (!folder.failures().empty()) return tl::unexpected(folder.failures().front());
  RunSummary summary;
  summary.folder = folder.path().string();
  summary.frames = static_cast<std::int64_t>(outcome.run.frames.size());
  summary.stopped = stop.stop_requested();
  summary.lost = outcome.lost;
  summary.metrics = internal::to_api(scores.metrics);
  return summary;
}

}  // namespace

RunSummary run(const std::string& input, const Settings& input_options, const Config& config,
               const RunOptions& options, const std::function<void(std::int64_t)>& progress,
               const Stop& stop) {
  return internal::guarded([&] {
    internal::check_threads(options.threads);
    const auto spec = internal::input_spec(input, input_options);
    auto opened = internal::value_or_raise(run::open_input(spec, options.threads));
    for (const std::string& warning : opened.info.warnings) log().warn("{}", warning);
    return internal::value_or_raise(
        run_input(opened, spec, config, options, progress, internal::StopAccess::token(stop)));
  });
}

}  // namespace sgs::api
