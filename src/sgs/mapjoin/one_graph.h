// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sgs/graph/pose_graph.h"
#include "sgs/loops/pose_graph.h"
#include "sgs/mapjoin/part.h"

namespace sgs::mapjoin {

/// Two maps as one graph.
struct OneGraph {
  std::vector<SE3> T_world_camera;  ///< of all views
  std::vector<graph::Edge> edges;   ///< that were believed: ways, loops of both, ties
  std::size_t ties = 0;             ///< how many of these
  bool solved = false;              ///< otherwise the poses are of no meaning
};

/// Poses that agree best with the ways and loops of both maps and the ties between them; ties and
/// loops may turn out to be wrong. The first view is held. `both`: side_by_side(), from number
/// `first` on the other map; `pose_graph`: of its views; `T_base_other`: where to begin.
OneGraph one_graph(const Part& both, std::size_t first, const loops::PoseGraph& pose_graph,
                   const std::vector<graph::Edge>& ties, const SE3& T_base_other);

/// Edges that say with their own certainty what the poses say.
std::vector<graph::Edge> at_rest(std::vector<graph::Edge> edges, const std::vector<SE3>& poses);

}  // namespace sgs::mapjoin
