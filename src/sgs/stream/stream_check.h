// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sgs/camera/rgbd_frame.h"
#include "sgs/stream/stream_source.h"

namespace sgs::stream {

/// What a camera is like, from some seconds of its stream: the page that people put into a report.
class StreamCheck final : public StreamWatcher {
 public:
  explicit StreamCheck(const Hello& hello) : hello_(hello) {}

  void on_packet(const Packet& packet) override;
  void on_samples(std::span<const InertialSample> samples) override;
  /// The frame that came of the packet before.
  void add(const RgbdFrame& frame);
  void add_event(std::string what) { events_.push_back(std::move(what)); }

  /// One finding: what, its value for people, and as a number where it is one.
  struct Line {
    std::string key, text;
    std::optional<double> value = {};
  };
  std::vector<Line> lines() const;

 private:
  void add_camera(std::vector<Line>& lines) const;
  void add_times(std::vector<Line>& lines) const;
  void add_clock(std::vector<Line>& lines) const;
  void add_images(std::vector<Line>& lines) const;
  void add_inertial(std::vector<Line>& lines) const;

  Hello hello_;
  std::vector<double> times_s_, delays_s_, exposures_s_, shares_, medians_m_, noises_m_;
  std::vector<std::pair<double, double>> received_;  // stamp and arrival, seconds
  std::vector<double> turned_s_, felt_s_, felt_m_s2_;
  std::vector<float> before_;  // depth of the frame before, metres
  std::vector<std::string> events_;
};

}  // namespace sgs::stream
