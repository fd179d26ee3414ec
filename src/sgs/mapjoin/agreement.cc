// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapjoin/agreement.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "sgs/graph/consistency.h"
#include "sgs/loops/drift.h"

namespace sgs::mapjoin {
namespace {

constexpr std::size_t kMost = 64;

const SE3& at(const std::vector<SE3>& poses, int view) {
  return poses[static_cast<std::size_t>(view)];
}

/// From one view of a map to another. A camera that turns on the spot drifts, too: a radian counts
/// as a metre.
graph::UncertainPose way(const std::vector<SE3>& poses, int from, int to,
                         const loops::DriftConfig& drift) {
  constexpr double kSeen = 1e9;  // 1/m^2: what is left is the drift
  const SE3 T = at(poses, from).inverse() * at(poses, to);
  return {T, loops::motion_covariance(kSeen * Matrix6d::Identity(), 1, T.t.norm() + T.angle(), 0,
                                      drift)};
}

bool agree(const graph::Edge& k, const graph::Edge& l, const std::vector<SE3>& poses,
           const loops::DriftConfig& drift) {
  const auto uncertain = [](const graph::Edge& e) {
    return graph::UncertainPose{e.T_from_to, graph::covariance_of(e.information)};
  };
  const auto round = uncertain(k) * way(poses, k.to, l.to, drift) * inverse(uncertain(l)) *
                     way(poses, l.from, k.from, drift);
  return closure_chi2(round) < graph::chi2_limit(6);
}

SE3 said_by(const graph::Edge& tie, const std::vector<SE3>& poses) {
  return at(poses, tie.from) * tie.T_from_to * at(poses, tie.to).inverse();
}

/// Of the ties the one that is nearest to all of them, seen from where they are.
SE3 middle(const std::vector<graph::Edge>& ties, const std::vector<SE3>& poses) {
  SE3 best;
  double least = -1;
  for (const graph::Edge& tie : ties) {
    const SE3 T = said_by(tie, poses);
    double sum = 0;
    for (const graph::Edge& other : ties) {
      const SE3 expected = at(poses, other.from).inverse() * T * at(poses, other.to);
      sum += (expected.inverse() * other.T_from_to).log().norm();
    }
    if (least >= 0 && sum >= least) continue;
    least = sum;
    best = T;
  }
  return best.normalized();
}

/// Maps that have drifted do not fit on each other everywhere. What is so far off is another place.
bool says_elsewhere(const graph::Edge& tie, const std::vector<SE3>& poses,
                    const SE3& T_base_other) {
  constexpr double kFar_m = 0.3, kFar_rad = 0.15;
  const SE3 expected = at(poses, tie.from).inverse() * T_base_other * at(poses, tie.to);
  const SE3 off = expected.inverse() * tie.T_from_to;
  return off.t.norm() > kFar_m || off.angle() > kFar_rad;
}

}  // namespace

Agreement agreement_of(const std::vector<graph::Edge>& ties, const std::vector<SE3>& poses,
                       const loops::DriftConfig& drift) {
  const std::size_t count = std::min(ties.size(), kMost);
  std::vector<std::uint64_t> agrees(count, 0);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (!agree(ties[i], ties[j], poses, drift)) continue;
      agrees[i] |= std::uint64_t{1} << j;
      agrees[j] |= std::uint64_t{1} << i;
    }
  }
  Agreement out;
  std::uint64_t believed = 0;
  for (const int i : graph::largest_agreement(agrees)) {
    out.ties.push_back(ties[static_cast<std::size_t>(i)]);
    believed |= std::uint64_t{1} << i;
  }
  out.T_base_other = middle(out.ties, poses);
  std::vector<std::size_t> others;
  for (std::size_t i = 0; i < count; ++i) {
    const bool agrees_not = (believed >> i & 1) == 0;
    if (agrees_not && says_elsewhere(ties[i], poses, out.T_base_other)) others.push_back(i);
  }
  std::vector<std::uint64_t> among(others.size(), 0);
  for (std::size_t a = 0; a < others.size(); ++a) {
    for (std::size_t b = 0; b < others.size(); ++b) {
      if ((agrees[others[a]] >> others[b] & 1) != 0) among[a] |= std::uint64_t{1} << b;
    }
  }
  out.rival = graph::largest_agreement(among).size();
  return out;
}

}  // namespace sgs::mapjoin
