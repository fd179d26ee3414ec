// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/eval/trajectory_metrics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>

#include "sgs/core/stopwatch.h"

namespace sgs::eval {
namespace {

constexpr double kNiceSlamMaxDifference_s = 0.08;
constexpr double kNiceSlamMinInterval_s = 1.0 / 32;
constexpr std::size_t kMinAlignedPairs = 3;
/// Keeps decimal limits such as 0.02 s inclusive in spite of rounding.
constexpr double kTimeSlack_s = 1e-9;

/// Position of the true pose nearest in time; the earlier one of two equally near.
std::size_t nearest(const std::vector<StampedPose>& truth, double timestamp_s) {
  const auto after = std::lower_bound(
      truth.begin(), truth.end(), timestamp_s,
      [](const StampedPose& pose, double time) { return pose.timestamp_s < time; });
  const auto i = static_cast<std::size_t>(after - truth.begin());
  if (i == 0) return 0;
  if (i == truth.size()) return i - 1;
  return truth[i].timestamp_s - timestamp_s < timestamp_s - truth[i - 1].timestamp_s ? i : i - 1;
}

/// One-to-one partners for the given estimates, closest pairs first; -1 = none.
std::vector<std::ptrdiff_t> nearest_one_to_one(const std::vector<PoseEstimate>& estimates,
                                               const std::vector<std::size_t>& wanted,
                                               const std::vector<StampedPose>& truth,
                                               double max_difference_s) {
  std::vector<std::tuple<double, std::size_t, std::size_t>> candidates;
  for (const std::size_t e : wanted) {
    const double time = estimates[e].timestamp_s;
    auto t = std::lower_bound(
        truth.begin(), truth.end(), time - max_difference_s - kTimeSlack_s,
        [](const StampedPose& pose, double limit) { return pose.timestamp_s < limit; });
    for (; t != truth.end() && t->timestamp_s - time <= max_difference_s + kTimeSlack_s; ++t) {
      candidates.emplace_back(std::abs(t->timestamp_s - time), e,
                              static_cast<std::size_t>(t - truth.begin()));
    }
  }
  std::sort(candidates.begin(), candidates.end());
  std::vector<std::ptrdiff_t> partner(estimates.size(), -1);
  std::vector<char> taken(truth.size(), 0);
  for (const auto& [difference, e, t] : candidates) {
    if (partner[e] >= 0 || taken[t]) continue;
    partner[e] = static_cast<std::ptrdiff_t>(t);
    taken[t] = 1;
  }
  return partner;
}

std::optional<RelativeError> relative_error(
    const std::vector<PosePair>& pairs,
    const std::vector<std::pair<std::size_t, std::size_t>>& deltas) {
  if (deltas.empty()) return std::nullopt;
  double translation = 0, rotation = 0;
  for (const auto& [i, j] : deltas) {
    // E = (Q_i^-1 Q_j)^-1 (P_i^-1 P_j), Q true, P estimated (Sturm et al. 2012, eq. 1).
    const SE3 truth = pairs[i].T_truth_camera.inverse() * pairs[j].T_truth_camera;
    const SE3 estimate = pairs[i].T_world_camera.inverse() * pairs[j].T_world_camera;
    const SE3 error = truth.inverse() * estimate;
    const double angle_deg = error.angle() * 180 / std::numbers::pi;
    translation += error.t.squaredNorm();
    rotation += angle_deg * angle_deg;
  }
  const auto n = static_cast<double>(deltas.size());
  return RelativeError{std::sqrt(translation / n), std::sqrt(rotation / n), deltas.size()};
}

std::string protocol_line(const TrajectoryMetrics& m, const TrajectoryOptions& options) {
  std::string rule;
  switch (options.association) {
    case Association::kInterpolate:
      rule = fmt::format(
          "ground truth interpolated over gaps up to {:g} s, else the nearest within {:g} s",
          options.max_gap_s, options.max_difference_s);
      break;
    case Association::kNearest:
      rule =
          fmt::format("nearest ground truth within {:g} s, one to one", options.max_difference_s);
      break;
    case Association::kNiceSlam:
      rule = "nearest ground truth within 0.08 s, thinned to 32 Hz (nice-slam)";
      break;
  }
  return fmt::format(
      "ATE: rigid alignment without scale over all paired frames; {}; {} frames, {} paired ({} "
      "interpolated), {} without ground truth, {} thinned, {} lost",
      rule, m.frames_total, m.paired, m.interpolated, m.dropped, m.thinned, m.lost);
}

void align(const Pairing& pairing, const TrajectoryOptions& options, TrajectoryMetrics& m) {
  std::vector<Eigen::Vector3d> source, target;
  for (const PosePair& pair : pairing.pairs) {
    source.push_back(pair.T_world_camera.t);
    target.push_back(pair.T_truth_camera.t);
  }
  const auto rigid = align_points(source, target, false);
  m.T_truth_world = rigid->T_target_source;
  std::vector<double> errors;
  std::int64_t tracked = 0;
  for (std::size_t i = 0; i < source.size(); ++i) {
    const PosePair& pair = pairing.pairs[i];
    const Eigen::Vector3d aligned = *m.T_truth_world * source[i];
    const double error = (aligned - target[i]).norm();
    errors.push_back(error);
    m.errors.push_back({pair.index, pair.timestamp_s, aligned, target[i], error});
    if (error <= options.tracked_error_m) ++tracked;
  }
  m.ate = error_statistics(errors);
  const auto population = m.frames_total - static_cast<std::int64_t>(m.thinned);
  if (population > 0) {
    m.tracked_percent = 100.0 * static_cast<double>(tracked) / static_cast<double>(population);
  }
  const auto spread = [](const std::vector<Eigen::Vector3d>& points) {
    double farthest = 0;
    for (const Eigen::Vector3d& p : points) farthest = std::max(farthest, (p - points[0]).norm());
    return farthest;
  };
  // A camera that stood still has no scale, only errors.
  if (std::min(spread(source), spread(target)) > std::max(1e-9, m.ate ? m.ate->rmse : 0.0)) {
    m.scale = align_points(source, target, true)->scale;
  }
}

}  // namespace

std::vector<PoseEstimate> to_estimates(const Trajectory& trajectory) {
  std::vector<PoseEstimate> estimates;
  for (const StampedPose& pose : trajectory.poses()) {
    estimates.push_back({static_cast<std::int64_t>(estimates.size()), pose.timestamp_s,
                         pose.T_world_camera, false});
  }
  return estimates;
}

std::string to_string(Association association) {
  switch (association) {
    case Association::kInterpolate:
      return "interpolate";
    case Association::kNearest:
      return "nearest";
    case Association::kNiceSlam:
      return "nice-slam";
  }
  return "unknown";
}

Result<Association> parse_association(std::string_view text) {
  for (const auto a : {Association::kInterpolate, Association::kNearest, Association::kNiceSlam}) {
    if (text == to_string(a)) return a;
  }
  return fail(ErrorCode::kInvalidArgument, fmt::format("unknown association '{}'", text),
              "use interpolate, nearest or nice-slam");
}

std::optional<ErrorStatistics> error_statistics(std::span<const double> errors) {
  if (errors.empty()) return std::nullopt;
  const auto n = static_cast<double>(errors.size());
  ErrorStatistics s;
  s.min = s.max = errors.front();
  double squares = 0;
  for (const double e : errors) {
    s.mean += e / n;
    squares += e * e / n;
    s.min = std::min(s.min, e);
    s.max = std::max(s.max, e);
  }
  double variance = 0;
  for (const double e : errors) variance += (e - s.mean) * (e - s.mean) / n;
  s.rmse = std::sqrt(squares);
  s.stddev = std::sqrt(variance);
  s.median = quantile({errors.begin(), errors.end()}, 0.5);
  return s;
}

Pairing associate(const std::vector<PoseEstimate>& estimates, const Trajectory& truth,
                  const TrajectoryOptions& options) {
  std::vector<std::size_t> order;
  Pairing result;
  for (std::size_t e = 0; e < estimates.size(); ++e) {
    if (estimates[e].T_world_camera.all_finite() && std::isfinite(estimates[e].timestamp_s)) {
      order.push_back(e);
    } else {
      ++result.unmatched;
    }
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return estimates[a].timestamp_s < estimates[b].timestamp_s;
  });
  const std::vector<StampedPose>& poses = truth.poses();
  std::vector<std::optional<SE3>> interpolated(estimates.size());
  std::vector<std::size_t> wanted;
  for (const std::size_t e : order) {
    if (options.association == Association::kInterpolate) {
      interpolated[e] = truth.at(estimates[e].timestamp_s, options.max_gap_s + kTimeSlack_s);
    }
    if (!interpolated[e]) wanted.push_back(e);
  }
  std::vector<std::ptrdiff_t> partner(estimates.size(), -1);
  if (options.association != Association::kNiceSlam) {
    partner = nearest_one_to_one(estimates, wanted, poses, options.max_difference_s);
  }
  double last_used_s = -std::numeric_limits<double>::infinity();
  for (const std::size_t e : order) {
    const PoseEstimate& estimate = estimates[e];
    std::optional<SE3> T_truth = interpolated[e];
    if (T_truth) {
      ++result.interpolated;
    } else if (options.association == Association::kNiceSlam && !poses.empty()) {
      const StampedPose& near = poses[nearest(poses, estimate.timestamp_s)];
      if (std::abs(near.timestamp_s - estimate.timestamp_s) < kNiceSlamMaxDifference_s) {
        if (!(estimate.timestamp_s - last_used_s > kNiceSlamMinInterval_s)) {
          ++result.thinned;
          continue;
        }
        last_used_s = estimate.timestamp_s;
        T_truth = near.T_world_camera;
      }
    } else if (partner[e] >= 0) {
      T_truth = poses[static_cast<std::size_t>(partner[e])].T_world_camera;
    }
    if (!T_truth) {
      ++result.unmatched;
      continue;
    }
    result.pairs.push_back(
        {e, estimate.index, estimate.timestamp_s, estimate.T_world_camera, *T_truth});
  }
  return result;
}

std::optional<RelativeError> relative_error_per_frame(const std::vector<PosePair>& pairs) {
  std::vector<std::pair<std::size_t, std::size_t>> deltas;
  for (std::size_t i = 1; i < pairs.size(); ++i) {
    if (pairs[i].index == pairs[i - 1].index + 1) deltas.emplace_back(i - 1, i);
  }
  return relative_error(pairs, deltas);
}

std::optional<RelativeError> relative_error_over_time(const std::vector<PosePair>& pairs,
                                                      double delta_s, double tolerance_s) {
  std::vector<std::pair<std::size_t, std::size_t>> deltas;
  std::size_t j = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const double wanted_s = pairs[i].timestamp_s + delta_s;
    const auto off = [&](std::size_t k) { return std::abs(pairs[k].timestamp_s - wanted_s); };
    j = std::max(j, i + 1);
    while (j + 1 < pairs.size() && off(j + 1) <= off(j)) ++j;
    if (j < pairs.size() && off(j) <= tolerance_s) deltas.emplace_back(i, j);
  }
  return relative_error(pairs, deltas);
}

namespace {

Metrics scores_of(const TrajectoryMetrics& m) {
  Metrics scores;
  scores.frames = m.frames_total;
  scores.tracked_percent = m.tracked_percent;
  if (m.scale) scores.scale_error_percent = 100 * (1 / *m.scale - 1);
  if (m.ate) {
    scores.ate_rmse_m = m.ate->rmse;
    scores.ate_mean_m = m.ate->mean;
    scores.ate_median_m = m.ate->median;
    scores.ate_max_m = m.ate->max;
  }
  if (m.rpe_1s) {
    scores.rpe_trans_1s_m = m.rpe_1s->translation_rmse_m;
    scores.rpe_rot_1s_deg = m.rpe_1s->rotation_rmse_deg;
  }
  return scores;
}

}  // namespace

TrajectoryMetrics evaluate_trajectory(const std::vector<PoseEstimate>& estimates,
                                      const Trajectory& truth, const TrajectoryOptions& options) {
  const Pairing pairing = associate(estimates, truth, options);
  TrajectoryMetrics m;
  m.estimates = estimates.size();
  m.frames_total =
      std::max(options.frames_total.value_or(0), static_cast<std::int64_t>(estimates.size()));
  m.lost = static_cast<std::size_t>(std::count_if(estimates.begin(), estimates.end(),
                                                  [](const PoseEstimate& e) { return e.lost; }));
  m.paired = pairing.pairs.size();
  m.dropped = pairing.unmatched;
  m.thinned = pairing.thinned;
  m.interpolated = pairing.interpolated;
  m.rpe_frame = relative_error_per_frame(pairing.pairs);
  m.rpe_1s = relative_error_over_time(pairing.pairs, 1.0);
  if (truth.empty()) {
    m.note = "no ground truth";
  } else if (estimates.empty()) {
    m.note = "no estimated poses";
  } else if (pairing.pairs.empty()) {
    m.note = "no estimated pose has ground truth near it in time";
  } else if (pairing.pairs.size() < kMinAlignedPairs) {
    m.note = fmt::format("only {} poses with ground truth; alignment needs {}",
                         pairing.pairs.size(), kMinAlignedPairs);
  } else {
    align(pairing, options, m);
  }
  m.protocol = protocol_line(m, options);
  m.scores = scores_of(m);
  return m;
}

}  // namespace sgs::eval
