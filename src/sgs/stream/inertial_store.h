// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <mutex>
#include <optional>
#include <span>
#include <string>

#include "sgs/dataset/imu.h"
#include "sgs/stream/protocol.h"

namespace sgs::stream {

/// Keeps what an inertial unit feels, as means over short times: enough to tell which way is up,
/// and 6 MB an hour whatever its rate. Thread-safe.
class InertialStore {
 public:
  static constexpr double kBin_s = 0.04;

  /// Samples with the greeting that they came after; `moved_s` is added to their times. Those that
  /// are no numbers or of no time after the last one are left out.
  void add(std::span<const InertialSample> samples, double moved_s, const Hello& hello);
  /// What there is so far; `source` is for people.
  dataset::ImuRecording recording(const std::string& source) const;

 private:
  void close_bin();

  mutable std::mutex mutex_;
  std::vector<ImuSample> samples_;
  std::optional<Eigen::Matrix3d> R_color_imu_;
  double bin_start_s_ = 0, time_sum_s_ = 0;
  Eigen::Vector3d sum_ = Eigen::Vector3d::Zero();
  int count_ = 0;
};

}  // namespace sgs::stream
