// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/stream/inertial_store.h"

namespace sgs::stream {

void InertialStore::close_bin() {
  if (count_ == 0) return;
  samples_.push_back({bin_start_s_ + time_sum_s_ / count_, sum_ / count_});
  count_ = 0;
  time_sum_s_ = 0;
  sum_.setZero();
}

void InertialStore::add(std::span<const InertialSample> samples, double moved_s,
                        const Hello& hello) {
  const std::lock_guard lock(mutex_);
  if (hello.T_color_imu) R_color_imu_ = hello.T_color_imu->R;
  for (const InertialSample& sample : samples) {
    const auto& a = sample.acceleration_m_s2;
    const Eigen::Vector3d acceleration(a[0], a[1], a[2]);
    if (!acceleration.allFinite()) continue;
    const double time_s = sample.timestamp_s + moved_s;
    const bool begun = count_ > 0 || !samples_.empty();
    if (begun && time_s < bin_start_s_) continue;
    if (!begun || time_s >= bin_start_s_ + kBin_s) {
      close_bin();
      bin_start_s_ = time_s;
    }
    sum_ += acceleration;
    time_sum_s_ += time_s - bin_start_s_;
    ++count_;
  }
}

dataset::ImuRecording InertialStore::recording(const std::string& source) const {
  const std::lock_guard lock(mutex_);
  dataset::ImuRecording recording;
  if (samples_.empty()) return recording;
  recording.source = source;
  recording.samples = samples_;
  recording.R_camera_imu = R_color_imu_;
  return recording;
}

}  // namespace sgs::stream
