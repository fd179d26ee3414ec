// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/alignment/movers/static_score.h"

#include <cmath>
#include <optional>

namespace sgs::alignment {
namespace {

// Of a segment that is so far off in the mean, nobody knows whether it moves.
constexpr double kUndecided = 0.3, kSteepness = 12;
// Weights, where a cell that is known has 1: of a pair of cells across a border, of the past.
constexpr double kBorder = 1, kPast = 8;
// Weight of a cell whose surface is where it was: what moves along itself looks so, too.
constexpr double kSeenStill = 0.3;
constexpr int kSteps = 20;  // of relaxation: farther than evidence has to reach

struct Sum {
  double value = 0, weight = 0;
  void add(double v, double w) {
    value += w * v;
    weight += w;
  }
  std::optional<double> mean() const {
    return weight > 0 ? std::optional(value / weight) : std::nullopt;
  }
};

}  // namespace

std::vector<float> score_still(const DepthSegments& segments, const std::vector<float>& off,
                               const std::vector<float>& before) {
  const auto count = static_cast<std::size_t>(segments.count);
  const auto is_measured = [&](std::size_t cell) {
    return segments.of[cell] != DepthSegments::kNone;
  };
  const auto of = [&](std::size_t cell) { return static_cast<std::size_t>(segments.of[cell]); };
  std::vector<Sum> evidence(count), past(count);
  for (std::size_t cell = 0; cell < off.size(); ++cell) {
    if (!is_measured(cell)) continue;
    if (!before.empty() && before[cell] >= 0) past[of(cell)].add(double{before[cell]}, 1);
    if (off[cell] >= 0) evidence[of(cell)].add(double{off[cell]}, 1);
  }
  std::vector<Sum> own(count);
  std::vector<std::optional<double>> still(count);
  for (std::size_t s = 0; s < count; ++s) {
    if (const auto mean = evidence[s].mean()) {
      const double weight = kSeenStill + (1 - kSeenStill) * *mean;
      own[s].add(1 / (1 + std::exp(kSteepness * (*mean - kUndecided))),
                 weight * evidence[s].weight);
    }
    if (const auto mean = past[s].mean()) own[s].add(*mean, kPast);
    still[s] = own[s].mean();
  }
  for (int i = 0; i < kSteps; ++i) {
    std::vector<Sum> sums = own;
    for (const DepthSegments::Border& b : segments.borders) {
      const double weight = kBorder * double{b.length};
      if (still[b.b]) sums[b.a].add(*still[b.b], weight);
      if (still[b.a]) sums[b.b].add(*still[b.a], weight);
    }
    for (std::size_t s = 0; s < count; ++s) still[s] = sums[s].mean();
  }
  std::vector<float> out(off.size());
  for (std::size_t cell = 0; cell < off.size(); ++cell) {
    if (is_measured(cell)) {
      out[cell] = static_cast<float>(still[of(cell)].value_or(kUnknownStill));
    } else if (off[cell] >= 0) {
      out[cell] = 1 - off[cell];
    } else {
      out[cell] = before.empty() ? kUnknownStill : before[cell];
    }
  }
  return out;
}

}  // namespace sgs::alignment
