// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

namespace sgs::run {

/// Follows how a disk fills while something is recorded onto it, whoever else writes there, too.
/// Times are those of any one clock, in seconds.
class DiskWatch {
 public:
  enum class Room {
    kEnough,
    kLow,   ///< it will not last for long
    kNone,  ///< what is left is for the end of the run: its map, its trajectory
  };
  /// `reserve_bytes` stay free.
  explicit DiskWatch(std::uintmax_t reserve_bytes) : reserve_bytes_(reserve_bytes) {}

  /// What `free_bytes` at `now_s` mean. Low does not flicker: it is over once there is twice the
  /// room.
  Room look(double now_s, std::uintmax_t free_bytes);
  /// Until the reserve is reached, at the rate of late; empty: the disk does not fill.
  std::optional<double> seconds_left() const { return seconds_left_; }

 private:
  struct Sample {
    double time_s;
    double free_bytes;
  };
  std::uintmax_t reserve_bytes_;
  std::optional<Sample> last_;
  double bytes_per_s_ = 0;  // smoothed
  std::optional<double> seconds_left_;
  Room room_ = Room::kEnough;
};

}  // namespace sgs::run
