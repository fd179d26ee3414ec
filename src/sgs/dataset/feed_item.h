// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "sgs/camera/rgbd_frame.h"
#include "sgs/dataset/frame_source.h"

namespace sgs::dataset {

/// One thing that came out of a source: a frame, the reason why there is none, or an event.
struct FeedItem {
  std::shared_ptr<const RgbdFrame> frame;  ///< null for a bad frame and an event
  std::int64_t index = 0;
  double timestamp_s = 0;
  std::string bad_reason;  ///< of an event: what happened
  bool event = false;      ///< no frame, good or bad; index and time mean nothing
};

/// Reads one item from a source without pacing; empty at its end.
std::optional<FeedItem> read_item(FrameSource& source);

}  // namespace sgs::dataset
