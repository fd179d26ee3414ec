// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sgs/graph/pose_graph.h"
#include "sgs/loops/loop_config.h"

namespace sgs::mapjoin {

/// Ties between two maps (edges from a view of the one to a view of the other, numbered through)
/// that say the same of where the one lies in the other.
struct Agreement {
  std::vector<graph::Edge> ties;  ///< the largest set that agrees pair by pair
  std::size_t rival = 0;          ///< size of the largest such set that says another place
  SE3 T_base_other;               ///< by the one in the middle of them, where there are any
};

/// Pairs agree whose way round (one tie, through the other map, the other tie back, and home)
/// closes within what the alignments say of themselves and what tracking drifts over ways of such
/// lengths. `poses`: of all views, each in the world of its own map. At most the first 64 ties are
/// looked at.
Agreement agreement_of(const std::vector<graph::Edge>& ties, const std::vector<SE3>& poses,
                       const loops::DriftConfig& drift);

}  // namespace sgs::mapjoin
