// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/api/evaluate.h"

#include "sgs/api/internal/convert.h"
#include "sgs/api/internal/guard.h"
#include "sgs/api/internal/metrics.h"
#include "sgs/api/internal/stop_token.h"
#include "sgs/core/log.h"
#include "sgs/eval/trajectory_metrics.h"
#include "sgs/run/score.h"

namespace sgs::api {

Metrics evaluate(const Trajectory& estimate, const Trajectory& truth,
                 const std::string& association) {
  return internal::guarded([&] {
    eval::TrajectoryOptions options;
    options.association = internal::value_or_raise(eval::parse_association(association));
    const auto poses = internal::value_or_raise(internal::from_api(estimate));
    const auto true_poses = internal::value_or_raise(internal::from_api(truth));
    const auto result = eval::evaluate_trajectory(eval::to_estimates(poses), true_poses, options);
    return internal::to_api(result.scores, eval::kTrajectoryGroup);
  });
}

Metrics evaluate_run(const std::string& folder, const EvaluateOptions& options, const Stop& stop) {
  return internal::guarded([&] {
    internal::check_threads(options.threads);
    run::ScoreOptions score;
    score.association = internal::value_or_raise(eval::parse_association(options.association));
    score.lpips_weights = options.lpips_weights;
    score.threads = options.threads;
    const run::Run run = internal::value_or_raise(run::load_run(folder, run::kAllParts));
    const auto scores =
        options.pictures
            ? internal::value_or_raise(run::score_run(run, score, run::RunObserver::nobody(),
                                                      internal::StopAccess::token(stop)))
            : run::score_trajectory(run, score.association);
    if (!scores.no_recording.empty()) log().warn("{}", scores.no_recording);
    if (stop.requested()) throw Error(ErrorCode::kInterrupted, "the evaluation was stopped");
    return internal::to_api(scores.metrics);
  });
}

namespace internal {

Metrics to_api(const eval::Metrics& metrics, std::string_view group) {
  Metrics out;
  eval::visit_metrics(metrics, [&](const eval::MetricInfo& info, const auto& field) {
    if (!group.empty() && info.group != group) return;
    Metric metric{std::string(info.key), std::string(info.unit), std::string(info.meaning), {}};
    if (field) metric.value = *field;
    out.push_back(std::move(metric));
  });
  return out;
}

}  // namespace internal
}  // namespace sgs::api
