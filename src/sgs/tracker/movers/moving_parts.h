// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <memory>
#include <vector>

#include "sgs/registration/cell_mask.h"
#include "sgs/tracker/local_past.h"
#include "sgs/tracker/movers/coarse_depth.h"

namespace sgs::tracker {

/// Tells which parts of a frame move by themselves, from what the last second's frames saw there.
class MovingParts {
 public:
  /// What a pose says of the frame.
  struct Judgement {
    registration::CellMask mask;
    std::vector<std::uint8_t> suspected;
    std::vector<float> still;  ///< of each cell: 1 stands still .. 0 moves
    double support = 0;        ///< how much of the older frames the pose explains
    double share = 0;          ///< of the measured cells that move
  };

  /// Looks at a frame.
  void look_at(const RgbdFrame& frame);
  Judgement judge(const SE3& T_local_camera, const LocalPast& past,
                  const registration::FrameMotion& motion);
  /// The frame was taken at a pose that is believed, and moves so.
  void remember(const Judgement& judgement, const registration::FrameMotion& motion);
  /// Whether something moved in the last frame that was remembered.
  bool moved() const { return moved_; }
  bool knows_anything() const { return !views_.empty(); }

 private:
  std::deque<CoarseDepth> views_;
  std::vector<float> still_;  // of the last frame
  std::vector<std::uint8_t> suspected_;
  bool moved_ = false;
  CoarseDepth view_;
};

}  // namespace sgs::tracker
