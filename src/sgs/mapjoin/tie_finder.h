// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sgs/alignment/local_past.h"
#include "sgs/graph/pose_graph.h"
#include "sgs/loops/loop_closer.h"
#include "sgs/loops/loop_verifier.h"
#include "sgs/mapjoin/part.h"
#include "sgs/tracker/relocaliser.h"

namespace sgs::mapjoin {

/// How far the search for a map in another one came.
struct Search {
  int looked = 0;      ///< views of the other map that were compared with those of the base
  int recognised = 0;  ///< of these: features agreed on a place
  int verified = 0;    ///< of these: surfaces and pictures agreed, of two views of the base
  /// The look that came nearest:
  int best_inliers = 0, best_matches = 0;   ///< features that agreed, and that were alike
  double best_view_s = 0, best_base_s = 0;  ///< times of both views in their sessions
};

/// Finds views of one map among those of another: as a camera that comes back finds itself there
/// (tracker::Relocaliser), and believed as a loop is (loops::LoopVerifier).
class TieFinder {
 public:
  /// `both`: the views of the base, then from number `first` on those of the other map
  /// (side_by_side()). What it refers to has to outlive it.
  TieFinder(const loops::LoopConfig& config, const tracker::TrackerConfig& tracker,
            const Part& both, std::size_t first);

  /// A view of the other map, looked for in all of the base: an edge from there to it.
  std::optional<graph::Edge> look_for(std::size_t number);
  /// A view of the other map, expected at `T_base_camera`. Any thread may call.
  std::optional<graph::Edge> look_at(std::size_t number, const SE3& T_base_camera) const;
  /// Whether the base has a view that sees so much of the same from there that look_at() is to be
  /// expected to find it.
  bool is_in_sight(const SE3& T_base_camera) const;
  const Search& search() const { return search_; }
  /// Depth of the other map over that of the base, measured where ties lay its views; empty where
  /// too little is known. @sa slam::MetreCheck
  std::optional<double> metre(const std::vector<graph::Edge>& ties) const;

  const loops::PoseGraph& pose_graph() const { return closer_.pose_graph(); }

 private:
  RgbdFrame frame(const alignment::KnownView& view, std::size_t number) const;
  std::vector<std::pair<double, int>> nearest(const SE3& T_base_camera) const;

  const Part& both_;
  std::size_t first_;
  loops::LoopConfig config_;
  PinholeCamera camera_;
  loops::LoopVerifier verifier_;
  loops::LoopCloser closer_;  // for its nodes
  tracker::Relocaliser relocaliser_;
  alignment::LocalPast past_;
  Search search_;
};

}  // namespace sgs::mapjoin
