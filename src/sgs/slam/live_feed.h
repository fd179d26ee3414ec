// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "sgs/camera/rgbd_frame.h"
#include "sgs/core/bounded_queue.h"
#include "sgs/dataset/frame_source.h"

namespace sgs::slam {

/// One thing that came out of a source: a frame, or the reason why there is none.
struct FeedItem {
  std::shared_ptr<const RgbdFrame> frame;  ///< null for a bad frame
  std::int64_t index = 0;
  double timestamp_s = 0;
  std::string bad_reason;
};

/// Plays a recorded source at the sensor's rate, as a camera would: a thread of its own releases
/// each frame at its time stamp; when the consumer is late the oldest waiting frame is dropped and
/// counted. The first frame is released at once.
class LiveFeed {
 public:
  /// `source` must outlive the feed; `capacity` >= 1 frames may wait.
  LiveFeed(dataset::FrameSource& source, std::size_t capacity);
  ~LiveFeed();
  LiveFeed(const LiveFeed&) = delete;
  LiveFeed& operator=(const LiveFeed&) = delete;

  /// Waits for the next frame; empty at the end of the source or after stop().
  std::optional<FeedItem> next() { return queue_.pop(); }
  /// Ends the playback; frames already waiting can still be read.
  void stop();
  /// Frames dropped so far.
  std::size_t dropped() const { return queue_.dropped(); }

 private:
  void play(dataset::FrameSource& source);

  BoundedQueue<FeedItem> queue_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

/// Reads one item from a source without pacing; empty at its end.
std::optional<FeedItem> read_item(dataset::FrameSource& source);

}  // namespace sgs::slam
