// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <vector>

#include "sgs/alignment/local_past.h"
#include "sgs/alignment/movers/coarse_depth.h"
#include "sgs/alignment/movers/surface_check.h"
#include "sgs/registration/cell_mask.h"

namespace sgs::alignment {

/// Tells which parts of a frame move by themselves: those whose surface stands where the frames of
/// the last half second saw none. Knows nothing of the map, which may have the movers in it. As
/// long as nothing moves, much has to move at once before anything is said to, and no one motion of
/// the camera may explain it: depth that is bent or late looks like things that move.
class MovingParts {
 public:
  /// What a pose says of the frame.
  struct Judgement {
    registration::CellMask mask;  ///< what moves
    std::vector<float> still;     ///< score_still() of each cell; empty where nothing moves
    double off_share = 0;         ///< of what stands still, the share that is off all the same
    double support = 0;           ///< how much of the older frames the pose explains
  };

  /// Looks at a frame.
  void look_at(const RgbdFrame& frame);
  /// What moves if it was taken there, and the camera moved so meanwhile. `past` has the frames
  /// that were remembered.
  Judgement judge(const SE3& T_local_camera, const registration::FrameMotion& motion,
                  const LocalPast& past);
  /// What somebody else has found to move in the frame.
  Judgement told(const registration::CellMask& moving) const;
  /// The judgement is believed: later frames are compared with this one.
  void remember(const Judgement& judgement, const registration::FrameMotion& motion);
  /// Whether something moved in the last frame that was remembered.
  bool moved() const { return !still_.empty(); }
  /// Whether there is a frame to compare with.
  bool has_past() const { return !past_depths_.empty(); }

 private:
  // An older frame, and from the camera of the frame's depth to that of its own.
  struct Compared {
    const CoarseDepth* then;
    SE3 T_then_now;
  };
  struct Off {
    std::vector<float> cells;  // SurfaceCheck::off, the largest of each cell
    double support = 0;
  };
  std::vector<const CoarseDepth*> compared_with() const;
  Off check(const std::vector<Compared>& with, double clock_s, int stride = 1) const;
  std::vector<Compared> fitted(std::vector<Compared> with,
                               const registration::CellMask& moving) const;
  bool one_motion_explains(std::vector<Compared> with) const;
  registration::CellMask coherent(const std::vector<float>& still,
                                  const std::vector<float>& depths) const;
  int columns() const { return depth_.depth.width() / SurfaceCheck::kCell; }

  CoarseDepth depth_;                    // of the frame that is looked at
  std::deque<CoarseDepth> past_depths_;  // oldest first
  float nearest_m_ = 0;                  // of it, where something moved before
  double noise_ratio_ = 1;               // of depth, to its model
  std::vector<float> still_;             // of the last of them; empty: nothing moved
};

}  // namespace sgs::alignment
