// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/capture/device_clock.h"

#include <algorithm>
#include <utility>

namespace sgs::capture {
namespace {

constexpr double kWrap_s = 4294.967296;  // 2^32 microseconds
constexpr double kWindow_s = 10;

}  // namespace

/// Not far behind the latest stamp, and no farther ahead than time has passed. What was held up on
/// the way comes in a burst: then less time passes here than between the stamps, but not by much.
bool DeviceClock::plausible(double time_s, double host_s) const {
  constexpr double kLate_s = 1, kAhead_s = 1;
  const double passed_s = std::max(0.0, host_s - latest_host_s_);
  return time_s > latest_s_ - kLate_s && time_s < latest_s_ + passed_s + kAhead_s;
}

double DeviceClock::continuous(double stamp_s, double host_s) {
  constexpr double kLeastStep_s = 1e-3;
  if (!std::exchange(begun_, true)) {
    latest_s_ = stamp_s;
    latest_host_s_ = host_s;
    first_ = recent_ = filling_ = {stamp_s, host_s - stamp_s, stamp_s};
    return stamp_s;
  }
  double time_s = stamp_s + offset_s_;
  if (!plausible(time_s, host_s)) {
    if (before_s_ && plausible(stamp_s + *before_s_, host_s)) {
      std::swap(*before_s_, offset_s_);
    } else {
      before_s_ = offset_s_;
      if (plausible(time_s + kWrap_s, host_s)) {
        offset_s_ += kWrap_s;
      } else {
        const double goes_on_s = latest_s_ + std::max(kLeastStep_s, host_s - latest_host_s_);
        jump_s_ = time_s - goes_on_s;
        offset_s_ = goes_on_s - stamp_s;
      }
    }
    time_s = stamp_s + offset_s_;
  }
  if (time_s > latest_s_) {
    latest_s_ = time_s;
    latest_host_s_ = host_s;
  }
  measure(time_s, host_s);
  return time_s;
}

void DeviceClock::measure(double time_s, double host_s) {
  const double delay_s = host_s - time_s;
  if (time_s >= filling_.start_s + kWindow_s) {
    if (!std::exchange(first_is_full_, true)) first_ = filling_;
    recent_ = filling_;
    filling_ = {time_s, delay_s, time_s};
  }
  if (delay_s < filling_.least_s) {
    filling_.least_s = delay_s;
    filling_.at_s = time_s;
  }
  if (!first_is_full_) recent_ = filling_;
}

double DeviceClock::drift_ppm() const {
  constexpr double kPerMillion = 1e6;
  const double between_s = recent_.at_s - first_.at_s;
  if (recent_.start_s <= first_.start_s || between_s < kWindow_s / 2) return 0;
  return kPerMillion * (recent_.least_s - first_.least_s) / between_s;
}

std::optional<double> DeviceClock::take_jump_s() { return std::exchange(jump_s_, std::nullopt); }

double DeviceClocks::continuous(int domain, double stamp_s, double host_s) {
  if (!reference_) reference_ = domain;
  DeviceClock& clock = clocks_[domain];
  const double time_s = clock.continuous(stamp_s, host_s);
  if (domain == *reference_) return time_s;
  return time_s + clock.host_minus_device_s() - clocks_[*reference_].host_minus_device_s();
}

const DeviceClock* DeviceClocks::reference() const {
  return reference_ ? &clocks_.at(*reference_) : nullptr;
}

std::vector<double> DeviceClocks::take_jumps_s() {
  std::vector<double> jumps_s;
  for (auto& [domain, clock] : clocks_) {
    if (const auto jump_s = clock.take_jump_s()) jumps_s.push_back(*jump_s);
  }
  return jumps_s;
}

}  // namespace sgs::capture
