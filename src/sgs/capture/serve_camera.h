// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>

#include "sgs/capture/camera_driver.h"

namespace sgs::capture {

/// How a camera's frames are sent.
struct ServeOptions {
  CameraMode mode;
  int skip = 15;            ///< first pairs left out: exposure settles
  std::int64_t frames = 0;  ///< then it is over; 0 = never
  bool listens = false;     ///< somebody sends lines
};

/// What is asked of a camera that is being served, from any thread.
struct ServeRequests {
  std::atomic<bool> stop{false}, lock_exposure{false};
};

/// Starts the camera and writes its stream (docs/stream.md, version 2) to a descriptor until it is
/// told to stop, has sent so many frames, or nobody reads any more. `say` is told what people
/// should know. Errors: no camera, one that is unplugged or silent, and what the driver says.
Status serve_camera(CameraDriver& driver, const ServeOptions& options, int descriptor,
                    const ServeRequests& requests, const std::function<void(std::string)>& say);

}  // namespace sgs::capture
