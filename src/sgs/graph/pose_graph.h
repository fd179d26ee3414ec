// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sgs/geometry/se3.h"

namespace sgs::graph {

/// A measured pose of node `to` in node `from`.
struct Edge {
  int from = 0, to = 0;
  SE3 T_from_to;
  /// Of the measurement, on twists of `to` (right perturbation, rotation first). Directions that
  /// the measurement did not see have none: the edge leaves them free.
  Matrix6d information = Matrix6d::Identity();
  /// Whether the edge may be wrong altogether, and is then to be left out.
  bool doubtful = false;
};

/// e = log(Z^-1 T_a^-1 T_b), what an edge disagrees by.
Vector6d disagreement(const Edge& edge, const SE3& T_world_from, const SE3& T_world_to);
/// e^T Lambda e.
double chi2(const Edge& edge, const SE3& T_world_from, const SE3& T_world_to);
/// Number of directions that an edge measures.
int rank(const Matrix6d& information);
/// The value that chi2 with so many degrees of freedom (1..6) exceeds once in a hundred times.
double chi2_limit(int degrees_of_freedom);

struct GraphSolution {
  std::vector<SE3> T_world_node;
  std::vector<double> weights;  ///< per edge: 1 = believed, 0 = left out
  std::vector<double> chi2;     ///< per edge, unweighted
  int steps = 0;                ///< Gauss-Newton steps in all
  bool found = true;            ///< false: the steps led nowhere, the poses are of no meaning
};

/// The poses that agree best with all edges: min sum w e^T Lambda e, the first node held. Doubtful
/// edges are weighted by graduated non-convexity with a truncated cost (Yang, Antonante, Tzoumas,
/// Carlone: Graduated Non-Convexity for Robust Spatial Perception, RA-L 2020, section IV.B), so
/// that one which cannot be reconciled ends with weight 0. Every node must be tied to the first by
/// edges of full rank that are not doubtful. One thread, the same bits always.
GraphSolution optimise(std::vector<SE3> T_world_node, const std::vector<Edge>& edges);

}  // namespace sgs::graph
