// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <exception>
#include <optional>
#include <thread>
#include <utility>

#include "sgs/core/bounded_queue.h"
#include "sgs/dataset/feed_item.h"

namespace sgs::slam {

/// Plays a recorded source at the sensor's rate, as a camera would: a thread of its own releases
/// each frame at its time stamp; when the consumer is late the oldest waiting frame is dropped and
/// counted. The first frame is released at once; a gap of more than ten seconds is
/// not waited for. A source that is live sets the pace itself.
class LiveFeed {
 public:
  /// `source` must outlive the feed; `capacity` >= 1 frames may wait.
  LiveFeed(dataset::FrameSource& source, std::size_t capacity);
  ~LiveFeed();
  LiveFeed(const LiveFeed&) = delete;
  LiveFeed& operator=(const LiveFeed&) = delete;

  /// Waits for the next frame; empty at the end of the source or after stop().
  /// What the source threw is thrown here, after the frames before it.
  std::optional<dataset::FeedItem> next() {
    auto item = queue_.pop();
    if (!item && !stop_ && failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
    return item;
  }
  /// Ends the playback; frames already waiting can still be read.
  void stop();
  /// Frames dropped so far.
  std::size_t dropped() const { return queue_.dropped(); }

 private:
  void play(dataset::FrameSource& source);

  BoundedQueue<dataset::FeedItem> queue_;
  std::atomic<bool> stop_{false};
  // Written before the thread closes the queue, read after it did; stop() closes it, too, and then
  // nobody looks.
  std::exception_ptr failure_;
  std::thread thread_;
};

}  // namespace sgs::slam
