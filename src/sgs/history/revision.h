// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "sgs/camera/depth_change.h"
#include "sgs/history/path.h"

namespace sgs::history {

/// Null: depth is taken as it was delivered.
using CalibrationPtr = std::shared_ptr<const DepthCalibration>;

/// What a back end, or the tracker itself, has found out about the past.
struct Update {
  PoseCorrection poses;
  CalibrationPtr calibration = {};  ///< another one of depth; null: that in force stays
  /// The tracker has looked again at frames and seen the camera move otherwise between them: not
  /// only where it was, but how it moved is another.
  bool tracked_anew = false;
};

/// What is believed of the past at a frame: where the camera was, and what its depth should have
/// been. Frames continue the path of a revision; a back end's update makes the next one, which
/// takes the place of all of it. A value, as cheap to copy as its path.
struct Revision {
  int loops = 0;         ///< revisions so far that gave other poses alone
  int calibrations = 0;  ///< those that gave another calibration
  int second_looks = 0;  ///< and those by which frames were tracked anew
  Path path;
  CalibrationPtr calibration;  ///< in force, of the frames that come and of those that came

  int number() const { return loops + calibrations + second_looks; }
};

/// The revision after `before`.
Revision revised(const Revision& before, const Update& update);

/// What `now` makes of depth that `then` has corrected; null where they are the same.
std::shared_ptr<const DepthChange> depth_change(const CalibrationPtr& then,
                                                const CalibrationPtr& now);

}  // namespace sgs::history
