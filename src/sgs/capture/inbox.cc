// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/capture/inbox.h"

#include <iterator>
#include <utility>

namespace sgs::capture {

double steady_now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void Inbox::take(CameraImage image) {
  image.host_s = steady_now_s();
  image.system_s =
      std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
  std::unique_lock lock(mutex_);
  if (waits_) went_.wait(lock, [&] { return closed_ || images_.size() < kMostImages; });
  if (closed_) return;
  images_.push_back(std::move(image));
  if (images_.size() > kMostImages) {
    images_.pop_front();
    ++dropped_;
  }
  came_.notify_one();
}

void Inbox::take(const stream::InertialSample& sample, int domain) {
  const std::lock_guard lock(mutex_);
  if (closed_ || samples_.size() >= kMostSamples) return;
  samples_.push_back({sample, domain, steady_now_s()});
}

Inbox::Delivery Inbox::collect(std::chrono::milliseconds time) {
  std::unique_lock lock(mutex_);
  came_.wait_for(lock, time, [&] { return !images_.empty() || closed_; });
  Delivery delivery;
  delivery.images.assign(std::make_move_iterator(images_.begin()),
                         std::make_move_iterator(images_.end()));
  images_.clear();
  delivery.samples = std::exchange(samples_, {});
  delivery.dropped = std::exchange(dropped_, 0);
  went_.notify_all();
  return delivery;
}

void Inbox::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  came_.notify_all();
  went_.notify_all();
}

}  // namespace sgs::capture
