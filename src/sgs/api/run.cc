// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/api/run.h"

#include "sgs/api/internal/access.h"
#include "sgs/api/internal/guard.h"
#include "sgs/api/internal/metrics.h"
#include "sgs/api/internal/stop_token.h"
#include "sgs/report/save_scores.h"
#include "sgs/run/whole_run.h"

namespace sgs::api {
namespace {

/// Tells a program the frames done.
class Telling : public run::RunObserver {
 public:
  explicit Telling(const std::function<void(std::int64_t)>& progress) : progress_(progress) {}
  void on_frame(slam::Session&, const dataset::FeedItem&, const slam::FrameRecord&) override {
    ++frames_;
    if (progress_) progress_(frames_);
  }

 private:
  const std::function<void(std::int64_t)>& progress_;
  std::int64_t frames_ = 0;
};

run::WholeRunOptions whole_run_options(const RunOptions& options) {
  run::WholeRunOptions whole;
  whole.run.threads = options.threads;
  whole.run.realtime = options.realtime;
  whole.run.record = options.record;
  whole.score.lpips_weights = options.lpips_weights;
  whole.pictures = options.pictures;
  return whole;
}

Result<RunSummary> run_input(run::Input& input, const run::InputSpec& spec, const Config& config,
                             const RunOptions& options,
                             const std::function<void(std::int64_t)>& progress,
                             const std::stop_token& stop) {
  SGS_ASSIGN_OR_RETURN(auto folder, options.output.empty()
                                        ? run::RunFolder::create_below("runs", input.info.name)
                                        : run::RunFolder::create(options.output));
  Telling observer(progress);
  SGS_ASSIGN_OR_RETURN(const auto whole,
                       run::run_whole(input, spec, config.modules(), whole_run_options(options),
                                      folder, observer, stop));
  const run::RunResult& result = whole.result;
  report::save_scores(result.run, whole.scores, folder);
  if (!result.input) return tl::unexpected(result.input.error());
  if (!folder.failures().empty()) return tl::unexpected(folder.failures().front());
  RunSummary summary;
  summary.folder = folder.path().string();
  summary.frames = static_cast<std::int64_t>(result.run.frames.size());
  summary.stopped = stop.stop_requested();
  summary.lost = result.lost;
  summary.metrics = internal::to_api(whole.scores.metrics);
  return summary;
}

}  // namespace

RunSummary run(const std::string& input, const Settings& input_options, const Config& config,
               const RunOptions& options, const std::function<void(std::int64_t)>& progress,
               const Stop& stop) {
  return internal::guarded([&] {
    internal::check_threads(options.threads);
    const auto spec = internal::input_spec(input, input_options);
    internal::check_or_raise(
        run::check_whole(spec, config.modules(), whole_run_options(options).run));
    auto opened = internal::value_or_raise(run::open_run_input(spec, options.threads));
    return internal::value_or_raise(
        run_input(opened, spec, config, options, progress, internal::StopAccess::token(stop)));
  });
}

}  // namespace sgs::api
