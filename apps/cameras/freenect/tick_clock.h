// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <utility>

namespace sgs::cameras::freenect {

/// Seconds of the Kinect's clock: 60 MHz in 32 bits, which wraps every 72 s. Colour and depth have
/// it in common, and may come a little out of order.
class TickClock {
 public:
  double seconds(std::uint32_t ticks) {
    constexpr double kPeriod_s = 1 / 60e6;
    if (!std::exchange(begun_, true)) total_ = ticks;
    const auto step = static_cast<std::int32_t>(ticks - static_cast<std::uint32_t>(total_));
    const std::int64_t now = total_ + step;
    if (step > 0) total_ = now;
    return kPeriod_s * static_cast<double>(now);
  }

 private:
  bool begun_ = false;
  std::int64_t total_ = 0;
};

}  // namespace sgs::cameras::freenect
