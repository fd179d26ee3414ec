// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "sgs/loops/loop_config.h"
#include "sgs/loops/loop_verifier.h"
#include "sgs/loops/pose_graph.h"

namespace sgs::loops {

/// Whether the odometry edge from node to node is what the two views say of it. Two variances are
/// told apart by how they close: that of an odometry edge against the alignment of its two views,
/// and that of alignments among themselves, over two whole steps (a -> b -> c against a -> c):
/// closer ones share their errors. Both are squared deviations per direction, in units of what an
/// edge claims.
class OdometryCheck {
 public:
  explicit OdometryCheck(const LoopConfig& config) : config_(config) {}

  /// Measures the odometry edge to the newest node. Where edges have lately contradicted the views
  /// by much more than views contradict each other: the edge that both together say, to be put in
  /// its place.
  std::optional<graph::UncertainPose> re_estimated(const PoseGraph& pose_graph,
                                                   const LoopVerifier& verifier);
  /// By how much the next edge is to be shorter than usual: less than 1 while odometry edges are
  /// re-estimated.
  double share() const { return share_; }
  /// What was measured so far is of another camera, or of another stretch.
  void forget() { *this = OdometryCheck(config_); }

 private:
  /// The median of the last values: a tracker that comes upon its old surfaces steps over to them,
  /// which one or two edges show, and rightly so. Drift is in all of them.
  class RunningMedian {
   public:
    void add(double value);
    double value() const;
    bool known() const { return !last_.empty(); }

   private:
    std::vector<double> last_;
  };

  void measure_closure(const PoseGraph& pose_graph, const LoopVerifier& verifier, double share);

  LoopConfig config_;
  RunningMedian contradiction_, closure_;
  double share_ = 1;
  std::vector<SE3> T_steps_;  // from node to node up to the newest one, as the views say
};

}  // namespace sgs::loops
