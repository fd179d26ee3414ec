// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "sgs/alignment/known_view.h"
#include "sgs/camera/rgbd_frame.h"
#include "sgs/features/ferns.h"
#include "sgs/history/revision.h"
#include "sgs/history/view_store.h"
#include "sgs/loops/loop_config.h"
#include "sgs/loops/loop_verifier.h"
#include "sgs/loops/odometry_check.h"
#include "sgs/loops/pose_graph.h"

namespace sgs::loops {

/// How many loops were looked at, and what became of them.
struct LoopCounts {
  int compared = 0;  ///< pairs of nodes
  int verified = 0;  ///< whose views could be aligned
  int gated = 0;     ///< of these: contradicted the drift there can have been
  int accepted = 0;  ///< of these: in the graph
  int taken_back = 0;
  int re_estimated = 0;  ///< odometry edges that contradicted the views
  int corrections = 0;
};

/// What tracking found of a frame, as far as loops ask.
struct TrackedFrame {
  bool lost = false;
  /// Of the pose, on twists of the camera; empty where the tracker does not know.
  std::optional<Matrix6d> information;
  registration::FrameMotion motion;  ///< of the camera while the frame was measured
};

/// Knows places again and says how the past has to move for them to be in one place only. A pure
/// function of what it is given, in order: deterministic, one thread.
///
/// What add() returns changes the path that it was given. The caller makes a revision of it when
/// it suits; until one comes there is no other.
class LoopCloser {
 public:
  /// `views`: where frames are remembered.
  LoopCloser(const LoopConfig& config, const PairConfig& pair, std::uint64_t seed,
             std::shared_ptr<history::ViewStore> views);

  /// Before the first frame: a view of a map that is gone on with becomes a node, under the last
  /// index of the path of `revision`. `frame` is what a camera like that of the frames to come saw
  /// there, `odometry` the measured way from the view before; empty: as tracked poses usually
  /// drift. The first frame that is tracked then hangs on the node whose view is nearest.
  void know(const alignment::KnownView& view, const RgbdFrame& frame,
            const history::Revision& revision, const std::optional<graph::UncertainPose>& odometry);
  /// After all views: a loop between two of them, by their numbers.
  void know(const graph::Edge& loop);
  /// Seed of the questions that the codes of nodes answer: that of the map's first view, if there
  /// is one.
  std::uint64_t fern_seed() const { return fern_seed_; }

  /// Takes in the next tracked frame, which is in the path of `revision`, as all before it are.
  /// Frames without information are passed over.
  std::optional<PoseCorrection> add(const RgbdFrame& frame, const TrackedFrame& tracked,
                                    const history::Revision& revision);

  const PoseGraph& pose_graph() const { return pose_graph_; }
  const LoopCounts& counts() const { return counts_; }

 private:
  void take_over(const history::Revision& revision);
  bool wants_node(const RgbdFrame& frame) const;
  void add_node(const RgbdFrame& frame, const TrackedFrame& tracked);
  std::vector<int> candidates(const std::vector<graph::UncertainPose>& predicted) const;
  void check_odometry();
  void tie_to_known_place(const Matrix6d& normal_equations);
  void look_for_loops();
  void accept_supported();
  bool is_time_to_solve() const;
  std::optional<PoseCorrection> correction();
  int spacing() const;
  std::vector<int> recently_tied() const;

  LoopConfig config_;
  LoopVerifier verifier_;
  OdometryCheck odometry_check_;
  std::uint64_t fern_seed_;
  features::Ferns ferns_;
  std::shared_ptr<history::ViewStore> views_;
  PinholeCamera camera_;
  PoseGraph pose_graph_;
  std::vector<graph::Edge> pending_;        // verified, without enough support so far
  bool is_apart_ = false;                   // what is known and what is tracked
  bool odometry_re_estimated_ = false;      // and the graph not solved since
  std::optional<std::int64_t> last_frame_;  // that was trusted
  double last_s_ = 0;
  double path_m_ = 0, gap_s_ = 0;  // since the last node
  std::size_t loops_solved_ = 0;
  double begin_s_ = 0, solved_s_ = 0;  // of the session, and of the last look at all loops
  LoopCounts counts_;
};

}  // namespace sgs::loops
