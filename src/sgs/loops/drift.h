// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/geometry/se3.h"
#include "sgs/graph/consistency.h"
#include "sgs/graph/pose_graph.h"
#include "sgs/loops/loop_config.h"

namespace sgs::loops {

/// What is farther does not count in the mean depth of a view.
inline constexpr double kFarthestDepth_m = 10;

/// What an alignment is worth as an edge of the pose graph: `normal_equations` (pixels and points
/// counted as independent) scaled by config.information_scale and bounded by config.floor_m along
/// each of its principal directions, where turns count by what they move at `mean_depth_m`.
/// Directions of less than `min_information` get exactly none.
Matrix6d edge_information(const Matrix6d& normal_equations, double mean_depth_m,
                          double min_information, const DriftConfig& config);

/// Covariance of the tracked motion from one node to the next, on twists of the latter: what the
/// alignment leaves open, and a drift that grows with the root of the way. `gap_s`: time without a
/// trusted pose in between.
Matrix6d motion_covariance(const Matrix6d& normal_equations, double mean_depth_m, double path_m,
                           double gap_s, const DriftConfig& config);

/// Squared deviation of a measured edge from where its node `to` was expected in node `from`. What
/// the edge did not see cannot contradict anything.
double deviation_chi2(const graph::Edge& edge, const graph::UncertainPose& expected);

}  // namespace sgs::loops
