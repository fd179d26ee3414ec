// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/synthetic/clocks.h"

#include <algorithm>
#include <cmath>

#include "sgs/dataset/association.h"
#include "sgs/synthetic/random.h"

namespace sgs::synthetic {

namespace {

// The recorded images of one camera: their numbers, when they were taken, their stamps.
struct Images {
  std::vector<std::int64_t> number;
  std::vector<double> taken_s, stamp_s;
};

struct Ticks {
  double first_s, rate_hz;
};

Images record(const ClockModel& model, const Ticks& ticks, double late_s, double end_s,
              std::uint64_t seed) {
  // The order of the stamps is that of the images.
  const double jitter_s = std::min(model.jitter_s, 0.1 / ticks.rate_hz);
  Images images;
  for (std::int64_t k = 0;; ++k) {
    const double taken_s = ticks.first_s + static_cast<double>(k) / ticks.rate_hz;
    if (taken_s > end_s) return images;
    const std::uint64_t h = hash64(seed, static_cast<std::uint64_t>(k));
    // The first image of a sequence is always there, as at the other levels.
    if (k > 0 && double{unit_float(hash64(h))} < model.lost) continue;
    const double error_s = jitter_s * double{GaussTable::instance()(h, 0)} + late_s;
    images.number.push_back(k);
    images.taken_s.push_back(taken_s);
    // Microseconds, as a file of time stamps would hold them.
    images.stamp_s.push_back(std::round((taken_s + error_s) * 1e6) / 1e6);
  }
}

}  // namespace

std::vector<FrameTimes> free_running_frames(const ClockModel& model, double start_s, double end_s,
                                            double rate_hz, std::uint64_t seed) {
  constexpr double kUsualRate_hz = 30, kPaired_s = 0.02;
  const Ticks color_ticks{start_s, rate_hz * model.color_rate};
  const double depth_hz = std::max(rate_hz, kUsualRate_hz) * model.depth_rate;
  const Ticks depth_ticks{start_s + (model.phase - 1) / depth_hz, depth_hz};
  const Images color = record(model, color_ticks, 0, end_s, hash64(seed, 1));
  const Images depth = record(model, depth_ticks, model.stamp_late_s, end_s, hash64(seed, 2));
  std::vector<FrameTimes> frames;
  for (const auto& [i, j] : dataset::associate(color.stamp_s, depth.stamp_s, kPaired_s))
    frames.push_back({color.number[i], color.taken_s[i], depth.taken_s[j], color.stamp_s[i],
                      depth.stamp_s[j] - color.stamp_s[i]});
  return frames;
}

}  // namespace sgs::synthetic
