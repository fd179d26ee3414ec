// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "sgs/camera/past_correction.h"
#include "sgs/camera/rgbd_frame.h"
#include "sgs/tracker/track_result.h"

namespace sgs::slam {

/// Looks at tracked frames one after the other and finds out now and then that the past was
/// different. A pure function of what it is given, in order.
class PastEstimator {
 public:
  virtual ~PastEstimator() = default;
  /// Takes in the next frame; null where nothing was found.
  virtual std::shared_ptr<const PastCorrection> add(const std::shared_ptr<const RgbdFrame>& frame,
                                                    const tracker::TrackResult& result) = 0;
  /// No more frames come; null where nothing more is found.
  virtual std::shared_ptr<const PastCorrection> finish() { return nullptr; }
  /// Poses of frames that come from now on are corrected, by this estimator or by another.
  virtual void note_applied(const PastCorrection& correction) = 0;
  /// What has been found so far, as a number for the records.
  virtual int found() const = 0;
};

}  // namespace sgs::slam
