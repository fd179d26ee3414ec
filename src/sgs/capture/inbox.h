// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <vector>

#include "sgs/capture/camera_driver.h"

namespace sgs::capture {

/// What a camera has delivered and nobody has looked at yet. Images beyond a few push out the
/// oldest ones, or wait, as it is asked for; samples never wait. Thread-safe.
class Inbox final : public CameraSink {
 public:
  struct Sample {
    stream::InertialSample sample;
    int domain = 0;
    double host_s = 0;
  };
  struct Delivery {
    std::vector<CameraImage> images;
    std::vector<Sample> samples;
    std::int64_t dropped = 0;  ///< images since the last one
  };

  explicit Inbox(bool waits) : waits_(waits) {}

  void take(CameraImage image) override;
  void take(const stream::InertialSample& sample, int domain) override;
  /// All that is there, at the latest after this time.
  Delivery collect(std::chrono::milliseconds time);
  /// Nothing waits any longer, and nothing is taken.
  void close();

 private:
  static constexpr std::size_t kMostImages = 8, kMostSamples = 4000;

  std::mutex mutex_;
  std::condition_variable came_, went_;
  std::deque<CameraImage> images_;
  std::vector<Sample> samples_;
  std::int64_t dropped_ = 0;
  bool waits_, closed_ = false;
};

/// Seconds of a clock that is never set.
double steady_now_s();

}  // namespace sgs::capture
