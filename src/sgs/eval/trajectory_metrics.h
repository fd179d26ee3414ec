// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sgs/eval/metrics.h"
#include "sgs/geometry/trajectory.h"

namespace sgs::eval {

/// One estimated pose of a sequence's frame.
struct PoseEstimate {
  std::int64_t index = 0;  ///< position of the frame in the sequence
  double timestamp_s = 0;
  SE3 T_world_camera;
  bool lost = false;  ///< the tracker itself did not trust this pose
};

/// The poses of a trajectory file as estimates numbered from 0, none of them lost.
std::vector<PoseEstimate> to_estimates(const Trajectory& trajectory);

/// How an estimate finds its true pose.
enum class Association {
  /// Ground truth interpolated at the estimate's time where its neighbours are at most `max_gap_s`
  /// apart; else the nearest true pose within `max_difference_s`, which must not have been taken by
  /// a closer estimate. The default.
  kInterpolate,
  /// One to one, closest pairs first, at most `max_difference_s` apart (TUM's associate.py).
  kNearest,
  /// The loader shared by NICE-SLAM, SplaTAM and GS-ICP SLAM: nearest within 0.08 s, several
  /// estimates may share a true pose; estimates not more than 1/32 s after the last used one are
  /// left out. For comparing with the tables of those papers.
  kNiceSlam,
};
std::string to_string(Association association);
/// Parses "interpolate", "nearest" or "nice-slam".
Result<Association> parse_association(std::string_view text);

struct TrajectoryOptions {
  Association association = Association::kInterpolate;
  double max_gap_s = 0.1;          ///< kInterpolate: longest gap of ground truth bridged
  double max_difference_s = 0.02;  ///< kInterpolate, kNearest
  double tracked_error_m = 1.0;    ///< a frame counts as tracked up to this aligned error
  /// Frames of the sequence, those without a pose included; empty = as many as estimates.
  std::optional<std::int64_t> frames_total;
};

/// Order statistics of non-negative errors.
struct ErrorStatistics {
  double rmse = 0, mean = 0, median = 0, stddev = 0, min = 0, max = 0;
};
/// Empty for no values. `stddev` is the population's (division by n).
std::optional<ErrorStatistics> error_statistics(std::span<const double> errors);

/// An estimate with its true pose.
struct PosePair {
  std::size_t estimate = 0;  ///< position in the list of estimates
  std::int64_t index = 0;    ///< frame index of the estimate
  double timestamp_s = 0;
  SE3 T_world_camera;  ///< estimated
  SE3 T_truth_camera;  ///< true, in the ground truth's world
};

/// Pairs of estimates and true poses in order of time, and what became of the other estimates.
struct Pairing {
  std::vector<PosePair> pairs;
  std::size_t interpolated = 0;  ///< pairs whose true pose was interpolated
  std::size_t unmatched = 0;     ///< estimates without ground truth near enough, or not finite
  std::size_t thinned = 0;       ///< estimates left out by the thinning of kNiceSlam
};
Pairing associate(const std::vector<PoseEstimate>& estimates, const Trajectory& truth,
                  const TrajectoryOptions& options);

/// Relative pose error (Sturm et al., IROS 2012, eq. 1) over pairs of frames a fixed delta apart.
struct RelativeError {
  double translation_rmse_m = 0;
  double rotation_rmse_deg = 0;
  std::size_t pairs = 0;
};
/// Over neighbouring frames (index difference 1). Empty without such pairs.
std::optional<RelativeError> relative_error_per_frame(const std::vector<PosePair>& pairs);
/// Over pairs closest to `delta_s` apart, at most `tolerance_s` off. Empty without such pairs.
std::optional<RelativeError> relative_error_over_time(const std::vector<PosePair>& pairs,
                                                      double delta_s, double tolerance_s = 0.05);

/// Aligned error of one frame.
struct FrameError {
  std::int64_t index = 0;
  double timestamp_s = 0;
  Eigen::Vector3d aligned_m;  ///< estimated position in the ground truth's world
  Eigen::Vector3d truth_m;
  double error_m = 0;  ///< distance of the two
};

/// Everything about a trajectory against ground truth. Values that the input does not determine are
/// empty, never NaN; `note` then says why.
struct TrajectoryMetrics {
  std::int64_t frames_total = 0;
  std::size_t estimates = 0;
  std::size_t lost = 0;     ///< estimates that the tracker marked as lost (they count in the ATE)
  std::size_t paired = 0;   ///< estimates with ground truth
  std::size_t dropped = 0;  ///< estimates without (Pairing::unmatched)
  std::size_t thinned = 0;
  std::size_t interpolated = 0;
  /// Absolute trajectory error after the rigid (Horn / Umeyama) alignment of all pairs. Needs three
  /// pairs: fewer can be aligned without error, whatever the estimate.
  std::optional<ErrorStatistics> ate;
  std::optional<SE3> T_truth_world;  ///< that alignment
  /// Scale that a similarity alignment would choose; reported for diagnosis, never applied. Empty
  /// where the estimate does not move.
  std::optional<double> scale;
  std::optional<RelativeError> rpe_frame;  ///< over 1 frame
  std::optional<RelativeError> rpe_1s;     ///< over 1 s
  /// Share of all frames of the sequence (less those thinned) with a pose within `tracked_error_m`
  /// of the truth. Frames without a pose or without ground truth count as not tracked.
  std::optional<double> tracked_percent;
  std::vector<FrameError> errors;  ///< one per pair; empty where `ate` is
  std::string note;                ///< why values are missing; empty when all are there
  std::string protocol;            ///< one line that says how the numbers were made
  Metrics scores;                  ///< what of it metrics.json holds
};
TrajectoryMetrics evaluate_trajectory(const std::vector<PoseEstimate>& estimates,
                                      const Trajectory& truth,
                                      const TrajectoryOptions& options = {});

}  // namespace sgs::eval
