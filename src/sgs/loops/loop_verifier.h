// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "sgs/camera/rgbd_frame.h"
#include "sgs/loops/loop_config.h"
#include "sgs/loops/pair_config.h"
#include "sgs/loops/pose_graph.h"

namespace sgs::loops {

/// Whether two nodes see the same place, and where one camera stands in the other's view if so.
class LoopVerifier {
 public:
  LoopVerifier(const LoopConfig& config, const PairConfig& pair) : config_(config), pair_(pair) {}

  /// Aligns the view of node `newer` to that of node `older` and, on its own, to the neighbours of
  /// `older`: an edge of the graph where the alignments hold and agree. They begin at
  /// `T_older_newer`, and where that fails at what matched features say.
  std::optional<graph::Edge> verify(const PoseGraph& pose_graph, int older, int newer,
                                    const SE3& T_older_newer) const;

  struct Found {
    SE3 T_older_newer;
    Matrix6d information;  ///< as of graph::Edge
  };
  /// The view of `newer` aligned to that of `older`, and nothing else asked. Empty where it cannot
  /// be, and where one of the views is forgotten or gone.
  std::optional<Found> measure(const PoseGraph& pose_graph, int older, int newer,
                               const SE3& T_start) const;

 private:
  /// What a node saw, and how it moved meanwhile.
  struct Sight {
    const Node* node;
    RgbdFrame frame;
  };
  static std::optional<Sight> sight(const PoseGraph& pose_graph, int node);
  std::optional<Found> align(const Sight& older, const Sight& newer, const SE3& T_start) const;
  std::optional<SE3> match_features(const RgbdFrame& older, const RgbdFrame& newer) const;
  bool agree(const Found& found, const SE3& other) const;

  LoopConfig config_;
  PairConfig pair_;
};

}  // namespace sgs::loops
