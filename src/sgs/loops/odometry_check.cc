// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/loops/odometry_check.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sgs/core/log.h"
#include "sgs/loops/drift.h"

namespace sgs::loops {
namespace {

/// Squared deviation per direction that the measurement sees.
double per_direction(const LoopVerifier::Found& found, const SE3& T_older_newer) {
  const Vector6d e = (T_older_newer.inverse() * found.T_older_newer).log();
  return e.dot(found.information * e) / graph::rank(found.information);
}

}  // namespace

void OdometryCheck::RunningMedian::add(double value) {
  constexpr std::size_t kMemory = 10;  // nodes
  if (last_.size() == kMemory) last_.erase(last_.begin());
  last_.push_back(value);
}

double OdometryCheck::RunningMedian::value() const {
  if (last_.empty()) return 0;
  std::vector<double> sorted = last_;
  std::sort(sorted.begin(), sorted.end());
  return sorted[(sorted.size() - 1) / 2];
}

// How alignments from node to node close with one over two whole steps.
void OdometryCheck::measure_closure(const PoseGraph& pose_graph, const LoopVerifier& verifier,
                                    double share) {
  const auto steps = static_cast<std::size_t>(std::lround(2 / share));
  const int c = pose_graph.size() - 1, a = c - static_cast<int>(steps);
  if (T_steps_.size() < steps || a < 0) return;
  if (pose_graph.node(a).number != pose_graph.node(c).number - static_cast<int>(steps)) return;
  SE3 T_a_c;
  for (auto T = T_steps_.end() - static_cast<std::ptrdiff_t>(steps); T != T_steps_.end(); ++T) {
    T_a_c = T_a_c * *T;
  }
  const auto over = verifier.measure(pose_graph, a, c, T_a_c);
  if (over) closure_.add(per_direction(*over, T_a_c) / static_cast<double>(steps + 1));
}

std::optional<graph::UncertainPose> OdometryCheck::re_estimated(const PoseGraph& pose_graph,
                                                                const LoopVerifier& verifier) {
  const double share = std::exchange(share_, 1);
  const int c = pose_graph.size() - 1, b = c - 1;
  if (b < 0) return std::nullopt;
  const graph::UncertainPose odometry = pose_graph.tracked(b, c);
  const auto seen = verifier.measure(pose_graph, b, c, odometry.T);
  const auto is_possible = [&](const LoopVerifier::Found& found) {
    const graph::Edge edge{b, c, found.T_older_newer, found.information, true};
    return deviation_chi2(edge, odometry) <= config_.max_gate_chi2;
  };
  if (!seen || !is_possible(*seen)) {
    T_steps_.clear();
    return std::nullopt;
  }
  const auto most_steps = static_cast<std::size_t>(std::lround(2 / config_.doubt_share));
  if (T_steps_.size() == most_steps) T_steps_.erase(T_steps_.begin());
  T_steps_.push_back(seen->T_older_newer);
  const double deviation = per_direction(*seen, odometry.T);
  // Drift that is the same everywhere grows with the way, its square with the square: so much it
  // would be over a whole step.
  contradiction_.add(deviation / (share * share));
  if (contradiction_.value() < config_.odometry_doubt) return std::nullopt;
  measure_closure(pose_graph, verifier, share);
  log().debug("odometry edge to node {}: {:.3f} against the views, usually {:.3f}; views {:.4f}",
              pose_graph.node(c).number, deviation, contradiction_.value(), closure_.value());
  if (!closure_.known() ||
      share * share * contradiction_.value() < config_.odometry_ratio * closure_.value()) {
    return std::nullopt;
  }
  share_ = config_.doubt_share;
  // Alignments of neighbours are as good as they close; what they claim is meant for views from
  // elsewhere, and so much is left in doubt.
  constexpr double kLeastClosure = 1e-3;
  const Matrix6d by_odometry = odometry.covariance.inverse();
  const Matrix6d by_views = seen->information / std::max(closure_.value(), kLeastClosure);
  const Vector6d e = (odometry.T.inverse() * seen->T_older_newer).log();
  const Vector6d step = (by_odometry + by_views).inverse() * (by_views * e);
  return graph::UncertainPose{odometry.T * SE3::exp(step),
                              (by_odometry + seen->information).inverse()};
}

}  // namespace sgs::loops
