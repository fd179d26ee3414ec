// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/alignment/movers/static_score.h"

#include <cmath>

namespace sgs::alignment {
namespace {

// Of a segment that is so far off in the mean, nobody knows whether it moves.
constexpr double kUndecided = 0.3, kSteepness = 12;
// Weights, where a cell that is known has 1: of a pair of cells across a border, of the past.
constexpr double kBorder = 1, kPast = 8;
constexpr int kSteps = 20;  // of relaxation: farther than evidence has to reach

struct Sum {
  double value = 0, weight = 0;
  void add(double v, double w) {
    value += w * v;
    weight += w;
  }
  double mean_or(double fallback) const { return weight > 0 ? value / weight : fallback; }
};

}  // namespace

std::vector<float> score_still(const DepthSegments& segments, const std::vector<float>& off,
                               const std::vector<float>& before) {
  const auto count = static_cast<std::size_t>(segments.count);
  std::vector<Sum> evidence(count), past(count);
  for (std::size_t cell = 0; cell < off.size(); ++cell) {
    if (segments.of[cell] == DepthSegments::kNone) continue;
    const auto s = static_cast<std::size_t>(segments.of[cell]);
    if (!before.empty()) past[s].add(double{before[cell]}, 1);
    if (off[cell] >= 0) evidence[s].add(double{off[cell]}, 1);
  }
  std::vector<Sum> own(count);
  std::vector<double> still(count);
  for (std::size_t s = 0; s < count; ++s) {
    const double odds = kSteepness * (evidence[s].mean_or(0) - kUndecided);
    own[s].add(1 / (1 + std::exp(odds)), evidence[s].weight);
    if (past[s].weight > 0) own[s].add(past[s].mean_or(1), kPast);
    still[s] = own[s].mean_or(1);
  }
  for (int i = 0; i < kSteps; ++i) {
    std::vector<Sum> sums = own;
    for (const DepthSegments::Border& b : segments.borders) {
      sums[b.a].add(still[b.b], kBorder * double{b.length});
      sums[b.b].add(still[b.a], kBorder * double{b.length});
    }
    for (std::size_t s = 0; s < count; ++s) still[s] = sums[s].mean_or(1);
  }
  std::vector<float> out(off.size(), 1.0f);
  for (std::size_t cell = 0; cell < off.size(); ++cell) {
    if (segments.of[cell] == DepthSegments::kNone) continue;
    out[cell] = static_cast<float>(still[static_cast<std::size_t>(segments.of[cell])]);
  }
  return out;
}

}  // namespace sgs::alignment
