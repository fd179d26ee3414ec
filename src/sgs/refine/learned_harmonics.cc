// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/refine/learned_harmonics.h"

#include <algorithm>
#include <cmath>

namespace sgs::refine {
namespace {

constexpr float kBeta1 = 0.9f, kBeta2 = 0.98f;
// Beyond the table both corrections are 1 to float precision.
constexpr int kTable = 1024;

}  // namespace

LearnedHarmonics::LearnedHarmonics(map::Harmonics start) : values_(std::move(start)) {
  for (int t = 1; t <= kTable; ++t) {
    correction1_.push_back(static_cast<float>(1 / (1 - std::pow(double{kBeta1}, t))));
    correction2_.push_back(static_cast<float>(1 / std::sqrt(1 - std::pow(double{kBeta2}, t))));
  }
  resize(values_.size());
}

void LearnedHarmonics::set_rate(double rate) { rate_ = static_cast<float>(rate); }

void LearnedHarmonics::resize(std::size_t count) {
  values_.resize(count);
  mean_.resize(values_.coefficients.size(), 0.0f);
  mean_square_.resize(values_.coefficients.size(), 0.0f);
}

void LearnedHarmonics::step(std::size_t i, std::uint32_t t, std::span<const float> gradient) {
  constexpr float kLeast = 1e-24f;  // smaller squares are noise of rounding
  const std::size_t entry = std::min<std::size_t>(std::max(t, 1u), kTable) - 1;
  const float rate = rate_ * correction1_[entry] / correction2_[entry];
  const std::size_t width = values_.floats();
  float* value = values_.coefficients.data() + i * width;
  float* m = mean_.data() + i * width;
  float* v = mean_square_.data() + i * width;
  for (std::size_t k = 0; k < width; ++k) {
    const float g = gradient[k];
    m[k] = kBeta1 * m[k] + (1 - kBeta1) * g;
    v[k] = kBeta2 * v[k] + (1 - kBeta2) * g * g;
    // What has come with more may keep it.
    const float largest = std::max(map::kLargestHarmonic, std::abs(value[k]));
    value[k] =
        std::clamp(value[k] - rate * m[k] / std::sqrt(std::max(v[k], kLeast)), -largest, largest);
  }
}

void LearnedHarmonics::remove(std::span<const char> removed) {
  if (empty()) return;
  const std::size_t width = values_.floats();
  std::size_t kept = 0;
  for (std::size_t i = 0; i < removed.size(); ++i) {
    if (removed[i] != 0) continue;
    if (kept != i) {
      for (auto* rows : {&values_.coefficients, &mean_, &mean_square_}) {
        const auto at = rows->begin();
        std::copy_n(at + static_cast<std::ptrdiff_t>(i * width), width,
                    at + static_cast<std::ptrdiff_t>(kept * width));
      }
    }
    ++kept;
  }
  resize(kept);
}

void LearnedHarmonics::split(std::size_t i) {
  const std::size_t width = values_.floats(), end = values_.coefficients.size();
  resize(values_.size() + 1);
  std::copy_n(values_.coefficients.data() + i * width, width, values_.coefficients.data() + end);
  for (auto* rows : {&mean_, &mean_square_}) std::fill_n(rows->data() + i * width, width, 0.0f);
}

}  // namespace sgs::refine
