// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "sgs/camera/rgbd_frame.h"

namespace sgs::api::internal {

/// Frames whose memory is used again when nobody holds them any more: fresh pages for the images of
/// each frame cost more than filling them. Any thread may let go of a frame, also when the pool is
/// gone.
class FramePool {
 public:
  /// A frame with the images of an earlier one, or with none.
  std::shared_ptr<RgbdFrame> take();

 private:
  struct Shelf {
    std::mutex mutex;
    std::vector<std::unique_ptr<RgbdFrame>> frames;
  };
  std::shared_ptr<Shelf> shelf_ = std::make_shared<Shelf>();
};

}  // namespace sgs::api::internal
