// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/run/disk_watch.h"

#include <algorithm>

namespace sgs::run {

DiskWatch::Room DiskWatch::look(double now_s, std::uintmax_t free_bytes) {
  constexpr double kSoon_s = 300;
  constexpr double kFollow_s = 5;  // over which the rate is smoothed
  const auto free = static_cast<double>(free_bytes);
  if (last_ && now_s > last_->time_s) {
    const double dt = now_s - last_->time_s;
    const double rate = std::max(0.0, (last_->free_bytes - free) / dt);
    bytes_per_s_ += (rate - bytes_per_s_) * std::min(1.0, dt / kFollow_s);
  }
  last_ = Sample{now_s, free};
  const double left = free - static_cast<double>(reserve_bytes_);
  seconds_left_.reset();
  if (bytes_per_s_ > 1) seconds_left_ = std::max(0.0, left / bytes_per_s_);
  if (left <= 0) {
    room_ = Room::kNone;
  } else if (const double soon_s = room_ == Room::kEnough ? kSoon_s : 2 * kSoon_s;
             seconds_left_ && *seconds_left_ < soon_s) {
    room_ = Room::kLow;
  } else {
    room_ = Room::kEnough;
  }
  return room_;
}

}  // namespace sgs::run
