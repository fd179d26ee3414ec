// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "sgs/alignment/alignment_config.h"
#include "sgs/history/path.h"
#include "sgs/tracker/track_result.h"
#include "sgs/tracker/tracker_config.h"

namespace sgs::tracker {

/// The part of SecondLook.
struct SecondLookConfig {
  alignment::AlignerConfig aligner;
  MotionConfig motion;

  explicit SecondLookConfig(const TrackerConfig& all)
      : aligner(aligner_config(all)), motion(all.motion) {}
};

/// Looks again at frames in which something began to move. When somebody who fills much of the view
/// sets off, or is there in the first picture, nothing tells at once whether they move or the
/// camera does; half a second later it is known who walks. So the last second is tracked once more
/// from there, backwards in time, against nothing but its own frames: whoever is known to walk is
/// left out from the beginning, and stands still, if ever, at the end. Of the two paths the
/// smoother one is believed: a camera that was dragged along by somebody has to jump back.
class SecondLook {
 public:
  explicit SecondLook(const SecondLookConfig& config) : config_(config) {}

  /// The next frame, which was tracked.
  void see(const std::shared_ptr<const RgbdFrame>& frame, const TrackResult& result);
  /// How the camera moved in the last second, and what follows from it for `path`, which has the
  /// frames that were seen; empty where nothing has moved lately, where it is not time to look
  /// again, and where what was said is the smoother path.
  std::optional<PoseCorrection> look_back(const history::Path& path);
  /// What was seen so far is of another place, or the camera is lost.
  void forget() { film_.clear(); }

 private:
  struct Seen {
    std::shared_ptr<const RgbdFrame> frame;
    registration::FrameMotion motion;
    std::shared_ptr<const PixelMask> still;
  };
  std::optional<std::vector<SE3>> play_backwards() const;

  SecondLookConfig config_;
  std::deque<Seen> film_;  // oldest first
  double readout_s_ = 0;   // of the camera, as learned so far
  double looked_s_ = 0;    // when it last looked back
  bool moves_ = false;     // something has moved since
};

}  // namespace sgs::tracker
