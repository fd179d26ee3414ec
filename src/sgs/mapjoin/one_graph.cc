// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapjoin/one_graph.h"

#include <utility>

namespace sgs::mapjoin {
namespace {

/// The maps hang together by ties, which may be wrong; a graph has to hang together without them.
Matrix6d hardly_any() { return 1e-4 * Matrix6d::Identity(); }

bool is_way(const graph::Edge& e) { return !e.doubtful && e.to == e.from + 1; }

}  // namespace

OneGraph one_graph(const Part& both, std::size_t first, const loops::PoseGraph& pose_graph,
                   const std::vector<graph::Edge>& ties, const SE3& T_base_other) {
  std::vector<SE3> poses = both.T_world_camera;
  for (std::size_t i = first; i < poses.size(); ++i) {
    poses[i] = (T_base_other * poses[i]).normalized();
  }
  std::vector<graph::Edge> edges;
  for (int k = 0; k + 1 < static_cast<int>(poses.size()); ++k) {
    const auto at = static_cast<std::size_t>(k);
    const SE3 T = poses[at].inverse() * poses[at + 1];
    const bool between = at + 1 == first;
    edges.push_back(
        {k, k + 1, T,
         between ? hardly_any() : Matrix6d(pose_graph.tracked(k, k + 1).covariance.inverse()),
         false});
  }
  for (const graph::Edge& e : both.graph.edges) {
    if (!is_way(e)) edges.push_back(e);
  }
  const std::size_t before_ties = edges.size();
  for (graph::Edge tie : ties) {
    tie.doubtful = true;
    edges.push_back(tie);
  }
  graph::GraphSolution solution = graph::optimise(std::move(poses), edges);
  OneGraph out;
  out.solved = solution.found;
  out.T_world_camera = std::move(solution.T_world_node);
  constexpr double kBelieved = 0.5;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (solution.weights[i] < kBelieved) continue;
    if (i >= before_ties) ++out.ties;
    out.edges.push_back(edges[i]);
  }
  return out;
}

std::vector<graph::Edge> at_rest(std::vector<graph::Edge> edges, const std::vector<SE3>& poses) {
  for (graph::Edge& e : edges) {
    e.T_from_to =
        poses[static_cast<std::size_t>(e.from)].inverse() * poses[static_cast<std::size_t>(e.to)];
  }
  return edges;
}

}  // namespace sgs::mapjoin
