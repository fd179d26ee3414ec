// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <exception>
#include <functional>
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
  /// Sees every item as the camera delivers it, also those that are dropped later; on the feed's
  /// own thread.
  using Delivered = std::function<void(const dataset::FeedItem&)>;

  /// `source` must outlive the feed; `capacity` >= 1 frames may wait.
  LiveFeed(dataset::FrameSource& source, std::size_t capacity, Delivered delivered = {});
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
  /// Frames that the camera has given so far, dropped ones included.
  std::size_t delivered() const { return delivered_; }

  /// Left out since hold(), so far.
  std::size_t left_out() const { return left_out_; }

  /// From now on frames are left out, those that wait included: nobody wants them. They count as
  /// neither delivered nor dropped. Once more changes nothing.
  void hold();
  /// Frames are wanted again. Returns how many were left out since hold().
  std::size_t release();

 private:
  void play(dataset::FrameSource& source);
  bool hand_on(dataset::FeedItem item);

  BoundedQueue<dataset::FeedItem> queue_;
  Delivered on_delivered_;
  std::size_t capacity_;
  std::atomic<bool> stop_{false}, held_{false};
  std::atomic<std::size_t> delivered_{0}, left_out_{0};
  // Written before the thread closes the queue, read after it did; stop() closes it, too, and then
  // nobody looks.
  std::exception_ptr failure_;
  std::thread thread_;
};

}  // namespace sgs::slam
