// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <string>

#include "sgs/geometry/se3.h"
#include "sgs/tracker/track_result.h"

namespace sgs::slam {

/// One line of frames.csv: what happened to one input frame.
struct FrameRecord {
  std::int64_t index = 0;  ///< position in the input, bad frames counted
  double timestamp_s = 0;
  bool bad = false;  ///< the frame could not be read; everything below is empty
  std::string bad_reason;
  SE3 T_odom_camera;  ///< the tracker's pose, before keyframe refinement (pose_correction.h)
  tracker::TrackingStatus status = tracker::TrackingStatus::kLost;
  tracker::LostReason lost_reason = tracker::LostReason::kNone;
  bool tracking_keyframe = false;
  bool mapping_keyframe = false;
  bool heldout = false;
  tracker::Diagnostics diagnostics;
  double track_ms = 0;          ///< thread CPU time of tracking, decoding excluded
  std::int64_t gaussians = 0;   ///< in the snapshot that this frame was tracked against
  std::int64_t iterations = 0;  ///< mapping iterations done when that snapshot was made
};

/// frames.csv: a header line and one line per record; empty cells where nothing was measured.
std::string frames_csv(const std::deque<FrameRecord>& records);

}  // namespace sgs::slam
