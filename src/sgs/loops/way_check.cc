// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/loops/way_check.h"

#include <algorithm>
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

void WayCheck::Usual::add(double value) {
  constexpr std::size_t kMemory = 10;  // nodes
  if (last_.size() == kMemory) last_.erase(last_.begin());
  last_.push_back(value);
}

double WayCheck::Usual::value() const {
  if (last_.empty()) return 0;
  std::vector<double> sorted = last_;
  std::sort(sorted.begin(), sorted.end());
  return sorted[(sorted.size() - 1) / 2];
}

std::optional<graph::UncertainPose> WayCheck::mended(const Skeleton& skeleton,
                                                     const LoopVerifier& verifier) {
  constexpr double kSteps = 3;  // alignments in a closed triangle
  const auto T_last_step = std::exchange(T_last_step_, std::nullopt);
  const int c = skeleton.size() - 1, b = c - 1, a = c - 2;
  if (b < 0) return std::nullopt;
  const graph::UncertainPose way = skeleton.tracked(b, c);
  const auto seen = verifier.measure(skeleton.node(b), skeleton.node(c), way.T);
  if (!seen) return std::nullopt;
  const graph::Edge edge{b, c, seen->T_older_newer, seen->information, true};
  if (deviation_chi2(edge, way) > config_.max_gate_chi2) return std::nullopt;
  T_last_step_ = seen->T_older_newer;
  const double deviation = per_direction(*seen, way.T);
  contradiction_.add(deviation);
  if (contradiction_.value() < config_.way_doubt) return std::nullopt;

  const auto number = [&](int node) { return skeleton.node(node).number; };
  if (T_last_step && a >= 0 && number(a) == number(c) - 2) {
    const SE3 T_a_c = *T_last_step * seen->T_older_newer;
    const auto over = verifier.measure(skeleton.node(a), skeleton.node(c), T_a_c);
    if (over) closure_.add(per_direction(*over, T_a_c) / kSteps);
  }
  log().debug("way to node {}: {:.3f} against the views, usually {:.3f}; views {:.4f}", number(c),
              deviation, contradiction_.value(), closure_.value());
  if (!closure_.known() || contradiction_.value() < config_.way_ratio * closure_.value()) {
    return std::nullopt;
  }
  // Alignments of neighbours are as good as they close; what they claim is meant for views from
  // elsewhere, and so much is left in doubt.
  constexpr double kLeastClosure = 1e-3;
  const Matrix6d by_way = way.covariance.inverse();
  const Matrix6d by_views = seen->information / std::max(closure_.value(), kLeastClosure);
  const Vector6d e = (way.T.inverse() * seen->T_older_newer).log();
  const Vector6d step = (by_way + by_views).inverse() * (by_views * e);
  return graph::UncertainPose{way.T * SE3::exp(step), (by_way + seen->information).inverse()};
}

}  // namespace sgs::loops
