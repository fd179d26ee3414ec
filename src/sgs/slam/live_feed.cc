// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/slam/live_feed.h"

#include <chrono>
#include <utility>

#include "sgs/core/log.h"

namespace sgs::slam {

LiveFeed::LiveFeed(dataset::FrameSource& source, std::size_t capacity, Delivered delivered)
    : queue_(capacity, FullPolicy::kDropOldest),
      on_delivered_(std::move(delivered)),
      capacity_(capacity),
      thread_([this, &source] { play(source); }) {}

LiveFeed::~LiveFeed() {
  stop();
  thread_.join();
}

void LiveFeed::stop() {
  stop_ = true;
  queue_.close();
}

void LiveFeed::hold() {
  if (held_.exchange(true)) return;
  while (auto item = queue_.try_pop()) left_out_ += item->event ? 0 : 1;
}

std::size_t LiveFeed::release() {
  held_ = false;
  return left_out_.exchange(0);
}

// Returns false when nobody takes anything any more.
bool LiveFeed::hand_on(dataset::FeedItem item) {
  if (stop_) return false;
  if (item.event) {
    // What happens to the camera is worth knowing, but displaces no frame.
    return held_ && queue_.size() >= capacity_ ? true : queue_.push(std::move(item));
  }
  if (held_) {
    ++left_out_;
    return true;
  }
  ++delivered_;
  if (on_delivered_) on_delivered_(item);
  return queue_.push(std::move(item));
}

void LiveFeed::play(dataset::FrameSource& source) {
  using Clock = std::chrono::steady_clock;
  constexpr std::chrono::seconds kLongestWait(10);
  Clock::time_point start;
  std::optional<double> first_time_s;
  bool gap_told = false;
  while (!stop_) {
    std::optional<dataset::FeedItem> item;
    try {
      item = dataset::read_item(source);  // decoded before its time: decoding delays nothing
    } catch (...) {
      failure_ = std::current_exception();  // next() hands it on, once the queue is empty
      break;
    }
    if (!item) break;
    if (source.live() || item->event) {
      if (!hand_on(std::move(*item))) break;
      continue;
    }
    if (!first_time_s) {
      first_time_s = item->timestamp_s;
      start = Clock::now();
    }
    auto due = start + std::chrono::duration_cast<Clock::duration>(
                           std::chrono::duration<double>(item->timestamp_s - *first_time_s));
    if (const auto now = Clock::now(); due - now > kLongestWait) {
      if (!std::exchange(gap_told, true)) {
        log().warn(
            "{:.1f} s without a frame before {:.3f} s: this gap is not waited for, nor are later "
            "ones as long; are the times in seconds?",
            std::chrono::duration<double>(due - now).count(), item->timestamp_s);
      }
      start -= due - now;
      due = now;
    }
    // Short naps instead of one long sleep: stop() must not wait for a gap in the recording.
    while (!stop_ && Clock::now() < due) {
      std::this_thread::sleep_until(std::min(due, Clock::now() + std::chrono::milliseconds(50)));
    }
    if (!hand_on(std::move(*item))) break;
  }
  queue_.close();
}

}  // namespace sgs::slam
