// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace sgs::capture {

/// Makes a clock that never jumps of a camera's own, which may wrap after 2^32 microseconds or be
/// set. Stamps go through unchanged until one of this happens. Images of several streams may come a
/// little out of order.
class DeviceClock {
 public:
  /// The continuous time of a stamp that came at `host_s` by a steady clock, seconds.
  double continuous(double stamp_s, double host_s);

  /// The least time from a stamp to its arrival, within the last ten seconds: where one clock
  /// stands by the other.
  double host_minus_device_s() const { return recent_.least_s; }
  /// By how much the host's clock runs faster; 0 within the first twenty seconds.
  double drift_ppm() const;
  /// By how much the clock was set, once for each time.
  std::optional<double> take_jump_s();

 private:
  struct Window {
    double start_s = 0;  ///< continuous time
    double least_s = 0;  ///< of host minus device
    double at_s = 0;     ///< continuous time of the least one
  };
  bool plausible(double time_s, double host_s) const;
  void measure(double time_s, double host_s);

  bool begun_ = false;
  double offset_s_ = 0;             // added to stamps
  std::optional<double> before_s_;  // the offset before that: late images still have it
  double latest_s_ = 0, latest_host_s_ = 0;
  std::optional<double> jump_s_;
  Window first_, recent_, filling_;
  bool first_is_full_ = false;
};

/// Clocks of several domains, brought to that of the first one: a camera may stamp one of its
/// sensors by itself and let the host stamp another.
class DeviceClocks {
 public:
  double continuous(int domain, double stamp_s, double host_s);
  const DeviceClock* reference() const;
  /// Jumps of any of them.
  std::vector<double> take_jumps_s();

 private:
  std::map<int, DeviceClock> clocks_;
  std::optional<int> reference_;
};

}  // namespace sgs::capture
