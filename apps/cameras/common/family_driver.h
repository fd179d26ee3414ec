// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "sgs/capture/camera_driver.h"

namespace sgs::cameras {

/// What the drivers of all families have in common.
class FamilyDriver : public capture::CameraDriver {
 public:
  stream::CameraFamily list() final {
    stream::CameraFamily family;
    const Status listed = list_into(family);
    if (!listed) family.problem = listed.error();
    return family;
  }
  /// Each is said once.
  std::vector<std::string> notes() final { return std::exchange(notes_, {}); }

 protected:
  /// As list(); what was found before it failed counts.
  virtual Status list_into(stream::CameraFamily& family) = 0;

  std::vector<std::string> notes_;
  capture::CameraSink* sink_ = nullptr;  ///< from start() to stop()
};

}  // namespace sgs::cameras
