// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "sgs/features/ferns.h"
#include "sgs/graph/consistency.h"
#include "sgs/graph/pose_graph.h"
#include "sgs/history/stored_view.h"
#include "sgs/registration/rolling_shutter.h"

namespace sgs::loops {

/// A frame that is remembered so that its place can be known again. Where it is, the path says.
struct Node {
  int number = 0;          ///< counts the nodes that there were, given by add()
  std::int64_t frame = 0;  ///< its index
  double timestamp_s = 0;
  double mean_depth_m = 0;
  registration::FrameMotion motion;  ///< of the camera while it was measured
  history::StoredViewPtr view;       ///< null: forgotten, the place is known by others
  features::FernCode ferns;
  bool left = false;  ///< the camera has looked elsewhere since
};

/// The nodes of a run, the odometry edge from each to the next, and the loops between them: what is
/// known of where they lie relative to each other, and how well.
class PoseGraph {
 public:
  /// What is believed of the past now, the frames of all nodes in its path; comes before the
  /// first node and with each frame. Where depth has changed, what was measured with the old one
  /// is held to deviate from the new poses as it did from the old ones; where frames were tracked
  /// anew, the odometry edges alone.
  void follow(const history::Revision& revision);
  const history::Revision& revision() const { return revision_; }

  int size() const { return static_cast<int>(nodes_.size()); }
  const Node& node(int index) const { return nodes_[static_cast<std::size_t>(index)]; }
  /// What node number `index` saw, its depth as known now; empty where its view is forgotten or
  /// gone.
  std::optional<RgbdFrame> seen(int index) const;
  /// Camera to odom.
  const SE3& pose(int index) const { return revision_.path.at(node(index).frame); }
  /// Appends a node; `motion_covariance` is that of the odometry edge from the last one, on twists
  /// of the new one (of no meaning for the first).
  void add(Node node, const Matrix6d& motion_covariance);
  /// Another odometry edge from the last node but one to the newest than the tracker said. Poses
  /// stay where they are until the graph is solved.
  void replace_last_odometry_edge(const graph::UncertainPose& odometry);
  /// Notes which nodes the newest one no longer sees.
  void note_left(const PinholeCamera& camera, double left_distance);

  /// How many nodes there were, those that have been joined to others included.
  int nodes_added() const { return added_; }

  /// Forgets views of places that were left until at most seven eighths of `most` are held, once
  /// there are more: always one of the two that show most alike, the newer one, as it has drifted
  /// more.
  void bound_views(const PinholeCamera& camera, std::size_t most);
  /// Joins the odometry edges to and from nodes whose views are forgotten and that no loop needs,
  /// so that what there is to solve grows with the places and not with the time. `others` are edges
  /// that are not in the graph yet; they and the loops are numbered anew.
  void join_odometry_edges(std::vector<graph::Edge>& others);

  const std::vector<graph::Edge>& loops() const { return loops_; }
  void add_loop(const graph::Edge& loop);
  void remove_last_loops(std::size_t count);
  /// Forgets every second loop, the newest quarter excepted, once there are more than `most`: what
  /// they said is in the poses, and the others between the same stretches hold it there.
  void thin_loops(std::size_t most);

  /// The odometry edge between two nodes, without loops.
  graph::UncertainPose tracked(int from, int to) const;
  /// Where every node lies relative to node `to`, by the surest way there is, loops included:
  /// T_node_to with covariance on twists of `to`.
  std::vector<graph::UncertainPose> relative_to(int to) const;

  /// The odometry edge to each node but the first, then the loops.
  std::vector<graph::Edge> edges() const;
  /// Poses that agree best with the odometry edges and the loops.
  graph::GraphSolution solve() const;
  /// Number of odometry edges in solve(): the first of its edges, one to each node but
  /// the first.
  int tracked_edges() const { return size() - 1; }

 private:
  struct Motion {
    SE3 T_from_to;
    Matrix6d covariance = Matrix6d::Zero(), information = Matrix6d::Zero();
  };
  static Motion joined(const Motion& first, const Motion& then);
  std::vector<SE3> poses() const;

  history::Revision revision_;
  std::vector<Node> nodes_;
  std::vector<Motion> motions_;  // to each node but the first
  std::vector<graph::Edge> loops_;
  int added_ = 0;
};

}  // namespace sgs::loops
