// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/stream/unit_doubts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "sgs/dataset/time_unit.h"

namespace sgs::stream {
namespace {

float median_of(std::span<float> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// As of a recording's times; and what steps as evenly as a camera, but in the hundredfold time, is
/// in milliseconds, even if they have fractions: a stream is no collection of single views.
dataset::TimeUnit unit_of(const std::vector<double>& times, bool whole) {
  constexpr double kSlowest = 5, kFastest = 1000, kPerSecond = 1e3;
  const double step = dataset::median_step(times);
  const dataset::TimeUnit unit = dataset::unit_of_times(times, whole);
  if (!unit.name.empty() || step < kSlowest || step > kFastest) return unit;
  return dataset::steps_evenly(times) ? dataset::TimeUnit{kPerSecond, "milliseconds"} : unit;
}

}  // namespace

std::optional<std::string> UnitDoubts::of_time(double sent) {
  constexpr std::size_t kEnough = 10;
  if (times_judged_ || !std::isfinite(sent)) return std::nullopt;
  times_.push_back(sent);
  if (times_.size() < kEnough) return std::nullopt;
  times_judged_ = true;
  const bool whole = std::ranges::all_of(times_, [](double t) { return t == std::floor(t); });
  const dataset::TimeUnit unit = unit_of(std::exchange(times_, {}), whole);
  if (unit.name.empty()) return std::nullopt;
  return fmt::format("its times look like {}, but `t` is in seconds: {}", unit.name,
                     unit.known ? fmt::format("divide it by {:g}", unit.per_second)
                                : "send when each frame was taken");
}

std::optional<std::string> UnitDoubts::of_depth(const DepthImage& depth_m) {
  // No depth camera for rooms and streets has half of its pixels nearer or farther.
  constexpr float kNearest_m = 0.03f, kFarthest_m = 150;
  constexpr std::size_t kEnough = 5;
  if (depth_judged_) return std::nullopt;
  std::vector<float> measured;
  for (const float z : std::span(depth_m.data(), depth_m.size())) {
    if (z > 0) measured.push_back(z);
  }
  if (measured.empty()) return std::nullopt;
  medians_m_.push_back(median_of(measured));
  if (medians_m_.size() < kEnough) return std::nullopt;
  depth_judged_ = true;
  const float median_m = median_of(medians_m_);
  if (median_m >= kNearest_m && median_m <= kFarthest_m) return std::nullopt;
  return fmt::format(
      "half of the depth is {} than {:g} m: is its unit another one? `f32` is in metres; of "
      "`u16` and `png16` `depth_scale` says how many units make one",
      median_m > kFarthest_m ? "farther" : "nearer", median_m);
}

std::optional<std::string> UnitDoubts::of_mask(const PixelMask* still) {
  // Who sends a mask sees people before a room: not for long more of them than of the room.
  constexpr float kMost = 0.75f;
  constexpr std::size_t kEnough = 10;
  if (masks_judged_ || still == nullptr) return std::nullopt;
  const auto moving = std::count(still->data(), still->data() + still->size(), std::uint8_t{0});
  moving_shares_.push_back(static_cast<float>(moving) / static_cast<float>(still->size()));
  if (moving_shares_.size() < kEnough) return std::nullopt;
  masks_judged_ = true;
  const float share = median_of(moving_shares_);
  if (share <= kMost) return std::nullopt;
  return fmt::format(
      "by its masks {:.0f} % of the picture move: are they the other way round? 0 stands for what "
      "is still, any other value for what moves",
      100 * share);
}

}  // namespace sgs::stream
