// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/stream/stream_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace sgs::stream {
namespace {

constexpr double kPerSecond_ms = 1e3, kPercent = 100;

/// The value below which this share of all lies; not of an empty list.
double quantile(std::vector<double> values, double share) {
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, values.begin() + at);
  return values[static_cast<std::size_t>(at)];
}

double median(std::vector<double> values) { return quantile(std::move(values), 0.5); }

std::vector<double> steps_of(const std::vector<double>& times_s) {
  std::vector<double> steps_s;
  for (std::size_t i = 1; i < times_s.size(); ++i) steps_s.push_back(times_s[i] - times_s[i - 1]);
  return steps_s;
}

/// How many a second; 0 where that cannot be told.
double rate_of(const std::vector<double>& times_s) {
  const double seconds = times_s.size() < 2 ? 0 : times_s.back() - times_s.front();
  return seconds > 0 ? static_cast<double>(times_s.size() - 1) / seconds : 0;
}

std::string camera_text(const LensCamera& lens) {
  const PinholeCamera& c = lens.camera;
  return fmt::format("{}x{}  fx {:.2f} fy {:.2f} cx {:.2f} cy {:.2f}{}", c.width, c.height, c.fx,
                     c.fy, c.cx, c.cy,
                     lens.distortion.is_zero()
                         ? ""
                         : fmt::format("  lens {:.4g}", fmt::join(lens.distortion.written(), " ")));
}

}  // namespace

void StreamCheck::on_packet(const Packet& packet) {
  times_s_.push_back(packet.timestamp_s);
  delays_s_.push_back(packet.depth_delay_s);
  if (packet.exposure_s) exposures_s_.push_back(*packet.exposure_s);
  if (packet.received_s) received_.emplace_back(packet.timestamp_s, *packet.received_s);
}

void StreamCheck::on_samples(std::span<const InertialSample> samples) {
  for (const InertialSample& sample : samples) {
    const auto& a = sample.acceleration_m_s2;
    if (std::isfinite(sample.angular_velocity_rad_s[0])) turned_s_.push_back(sample.timestamp_s);
    if (!std::isfinite(a[0])) continue;
    felt_s_.push_back(sample.timestamp_s);
    felt_m_s2_.push_back(std::hypot(a[0], a[1], a[2]));
  }
}

void StreamCheck::add(const RgbdFrame& frame) {
  // A median of differences of neighbouring frames is 0.674 sqrt(2) deviations of one of them.
  constexpr double kDeviation = 0.95387;
  std::vector<double> depths_m, changes_m;
  const std::size_t count = frame.depth.size();
  const float* depth = frame.depth.data();
  for (std::size_t i = 0; i < count; ++i) {
    if (!(depth[i] > 0)) continue;
    depths_m.push_back(static_cast<double>(depth[i]));
    if (i < before_.size() && before_[i] > 0) {
      changes_m.push_back(static_cast<double>(std::abs(depth[i] - before_[i])));
    }
  }
  shares_.push_back(count > 0 ? static_cast<double>(depths_m.size()) / static_cast<double>(count)
                              : 0);
  if (!depths_m.empty()) medians_m_.push_back(median(std::move(depths_m)));
  if (!changes_m.empty()) noises_m_.push_back(median(std::move(changes_m)) / kDeviation);
  before_.assign(depth, depth + count);
}

void StreamCheck::add_camera(std::vector<Line>& lines) const {
  lines.push_back({"name", hello_.name});
  lines.push_back({"colour", camera_text(hello_.color_camera)});
  if (hello_.depth_camera) {
    lines.push_back({"depth", camera_text(*hello_.depth_camera)});
    const double apart_mm = kPerSecond_ms * hello_.T_color_depth.t.norm();
    lines.push_back(
        {"cameras apart", fmt::format("{:.1f} mm, brought together by us", apart_mm), apart_mm});
  } else {
    lines.push_back({"depth", "in the pixels of colour"});
  }
  lines.push_back(
      {"unit", fmt::format("{:g} raw units per metre", hello_.depth_scale), hello_.depth_scale});
  if (hello_.laser) lines.push_back({"projector", *hello_.laser ? "on" : "off"});
}

void StreamCheck::add_times(std::vector<Line>& lines) const {
  constexpr double kGap = 1.5;
  const auto steps_s = steps_of(times_s_);
  lines.push_back({"frames", fmt::format("{}", times_s_.size()), times_s_.size()});
  if (steps_s.empty()) return;
  const double period_s = median(steps_s), longest_s = std::ranges::max(steps_s);
  std::vector<double> off_s;
  for (const double step_s : steps_s) off_s.push_back(std::abs(step_s - period_s));
  const auto gaps = std::ranges::count_if(steps_s, [&](double s) { return s > kGap * period_s; });
  lines.push_back({"rate", fmt::format("{:.2f} a second", rate_of(times_s_)), rate_of(times_s_)});
  lines.push_back({"gaps",
                   fmt::format("{}, the longest step {:.1f} ms", gaps, kPerSecond_ms * longest_s),
                   static_cast<double>(gaps)});
  lines.push_back({"jitter of stamps",
                   fmt::format("{:.2f} ms in 95 of 100", kPerSecond_ms * quantile(off_s, 0.95)),
                   kPerSecond_ms * quantile(off_s, 0.95)});
  lines.push_back({"depth after colour",
                   fmt::format("{:+.2f} ms ({:+.2f} to {:+.2f})", kPerSecond_ms * median(delays_s_),
                               kPerSecond_ms * std::ranges::min(delays_s_),
                               kPerSecond_ms * std::ranges::max(delays_s_)),
                   kPerSecond_ms * median(delays_s_)});
}

/// By the fastest arrivals of the first and the last third: they waited least.
void StreamCheck::add_clock(std::vector<Line>& lines) const {
  constexpr std::size_t kLeast = 30;
  constexpr double kPerMillion = 1e6;
  if (received_.size() < 2) return;
  std::vector<double> waits_s;
  for (const auto& [stamp_s, arrival_s] : received_) waits_s.push_back(arrival_s - stamp_s);
  const double least_s = std::ranges::min(waits_s), late_s = quantile(waits_s, 0.95) - least_s;
  lines.push_back({"jitter of arrival",
                   fmt::format("{:.1f} ms in 95 of 100", kPerSecond_ms * late_s),
                   kPerSecond_ms * late_s});
  if (received_.size() < kLeast) return;
  const auto third = static_cast<std::ptrdiff_t>(waits_s.size() / 3);
  const auto first = std::min_element(waits_s.begin(), waits_s.begin() + third);
  const auto last = std::min_element(waits_s.end() - third, waits_s.end());
  const auto at = [&](auto it) {
    return received_[static_cast<std::size_t>(it - waits_s.begin())].first;
  };
  const double drift_ppm = kPerMillion * (*last - *first) / (at(last) - at(first));
  lines.push_back({"drift of the clock", fmt::format("{:+.0f} ppm", -drift_ppm), -drift_ppm});
}

void StreamCheck::add_images(std::vector<Line>& lines) const {
  if (!exposures_s_.empty()) {
    lines.push_back(
        {"exposure",
         fmt::format("{:.2f} to {:.2f} ms", kPerSecond_ms * std::ranges::min(exposures_s_),
                     kPerSecond_ms * std::ranges::max(exposures_s_)),
         kPerSecond_ms * median(exposures_s_)});
  }
  if (!shares_.empty()) {
    lines.push_back({"pixels with depth", fmt::format("{:.1f} %", kPercent * median(shares_)),
                     median(shares_)});
  }
  if (!medians_m_.empty()) {
    lines.push_back(
        {"median depth", fmt::format("{:.3f} m", median(medians_m_)), median(medians_m_)});
  }
  if (!noises_m_.empty()) {
    const double noise_mm = kPerSecond_ms * median(noises_m_);
    lines.push_back(
        {"noise of depth", fmt::format("{:.2f} mm, if nothing moved", noise_mm), noise_mm});
  }
}

void StreamCheck::add_inertial(std::vector<Line>& lines) const {
  if (!hello_.T_color_imu) {
    lines.push_back({"inertial unit", "none"});
    return;
  }
  lines.push_back(
      {"accelerometer", fmt::format("{:.1f} a second", rate_of(felt_s_)), rate_of(felt_s_)});
  lines.push_back(
      {"gyroscope", fmt::format("{:.1f} a second", rate_of(turned_s_)), rate_of(turned_s_)});
  if (felt_m_s2_.empty()) return;
  lines.push_back(
      {"felt", fmt::format("{:.2f} m/s2 (at rest 9.81)", median(felt_m_s2_)), median(felt_m_s2_)});
}

std::vector<StreamCheck::Line> StreamCheck::lines() const {
  std::vector<Line> lines;
  add_camera(lines);
  add_times(lines);
  add_clock(lines);
  add_images(lines);
  add_inertial(lines);
  for (const std::string& event : events_) lines.push_back({"event", event});
  return lines;
}

}  // namespace sgs::stream
