// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <string>
#include <vector>

#include "sgs/capture/image_pairs.h"
#include "sgs/core/error.h"
#include "sgs/stream/camera_program.h"
#include "sgs/stream/protocol.h"

namespace sgs::capture {

/// What a camera is asked for.
struct CameraMode {
  int width = 640, height = 480, fps = 30;
  bool given = false;        ///< somebody chose it: it is tried even where it should not work
  bool imu = true;           ///< wanted, if there is one
  bool every_frame = false;  ///< the camera waits rather than images are dropped
  std::string serial;        ///< empty: the first camera that is there
};

/// Takes what a camera delivers, on whatever thread.
class CameraSink {
 public:
  virtual ~CameraSink() = default;
  virtual void take(CameraImage image) = 0;
  /// A sample of one half of an inertial unit, its time by the clock `domain`.
  virtual void take(const stream::InertialSample& sample, int domain) = 0;
};

/// A family of cameras, through its library. One thread.
class CameraDriver {
 public:
  virtual ~CameraDriver() = default;

  /// The library that is found and the cameras that are plugged in.
  virtual stream::CameraFamily list() = 0;
  /// Starts a camera. The greeting has its factory calibration; what is odd goes to notes(). `sink`
  /// must live until stop().
  virtual Result<stream::Hello> start(const CameraMode& mode, CameraSink& sink) = 0;
  virtual std::vector<std::string> notes() { return {}; }
  /// Whether the camera is still plugged in; asked when nothing has come for a while.
  virtual bool present() = 0;
  /// What is said when it is not, or when nothing has come for so long although it is.
  virtual Error gone() const {
    return {ErrorCode::kIo, "the camera was unplugged", "plug it in again"};
  }
  virtual Error silent(double seconds) const {
    return {ErrorCode::kIo, fmt::format("the camera has given no image for {:.0f} s", seconds),
            "unplug it and plug it in again; a cable or port of USB 3 that is loose does this"};
  }
  /// Keeps exposure and white balance as they are now.
  virtual Status lock_exposure() = 0;
  virtual void stop() = 0;
};

}  // namespace sgs::capture
