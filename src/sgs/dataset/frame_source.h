// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "sgs/camera/pinhole.h"
#include "sgs/camera/rgbd_frame.h"
#include "sgs/core/error.h"
#include "sgs/geometry/trajectory.h"

namespace sgs::dataset {

/// What reading one frame gave.
enum class FrameRead {
  kOk,        ///< `frame` is filled
  kBadFrame,  ///< this frame could not be used (`error` says why); the next one may be fine
  kEvent,     ///< no frame: something happened to the source (`error` says what); it goes on
  kEnd,       ///< no more frames
};

/// A sequence of RGB-D frames, delivered one by one in time order. Frames come out undistorted and
/// registered. Not thread-safe: one reader.
class FrameSource {
 public:
  virtual ~FrameSource() = default;

  /// Short name for logs and reports, e.g. "7scenes_redkitchen_600" or "synth:room_desk".
  virtual std::string name() const = 0;
  /// Camera of the frames as delivered (undistorted).
  virtual PinholeCamera camera() const = 0;
  /// Number of frames next() will go through, bad ones included; empty if not known in advance.
  virtual std::optional<std::int64_t> size() const = 0;
  /// All of the ground truth, in its own time base; empty where there is none.
  virtual const Trajectory& ground_truth() const = 0;
  /// Reads the next frame into `frame`. On kBadFrame `error` names the file and the reason, and
  /// `frame.index` and `frame.timestamp_s` are valid.
  virtual FrameRead next(RgbdFrame& frame, Error& error) = 0;
  /// Whether frames come when a camera has them: then nobody else sets the pace. Only such sources
  /// have events: a frame that does not come, a connection that breaks or is there again.
  virtual bool live() const { return false; }
  /// Asks a next() that waits, and all later ones, to return kEnd soon. Thread-safe; a source that
  /// never waits for long need not listen.
  virtual void stop() {}
};

}  // namespace sgs::dataset
