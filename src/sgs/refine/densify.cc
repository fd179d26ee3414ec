// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/refine/densify.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace sgs::refine {
namespace {

float largest_log_scale(const map::Gaussian& g) {
  return std::max({g.log_scale[0], g.log_scale[1], g.log_scale[2]});
}

bool is_finite(const map::Gaussian& g) {
  float sum = g.opacity_logit;
  for (int k = 0; k < 3; ++k) sum += g.mean[k] + g.log_scale[k] + g.rgb[k];
  for (const float q : g.rotation) sum += q;
  return std::isfinite(sum);
}

float logit(float opacity) { return std::log(opacity / (1 - opacity)); }

/// Puts a half in the place of number `i`: nothing is remembered of the whole.
void replace(std::size_t i, const map::Gaussian& half, map::GaussianStore& store) {
  store.raw[i] = store.average[i] = half;
  store.moments[i] = {};
  store.steps[i] = 0;
}

}  // namespace

void GaussianNotes::begin(std::size_t count) {
  pull.resize(count, 0.0f);
  pixel_m.resize(count, kNeverSeen);
}

void GaussianNotes::fade() {
  constexpr float kKept = 0.6f;
  for (float& p : pull) p *= kKept;
}

std::size_t remove_useless(double opacity, map::GaussianStore& store, GaussianNotes& notes,
                           LearnedHarmonics& harmonics) {
  const float least = logit(static_cast<float>(opacity));
  std::vector<char> useless(store.size());
  for (std::size_t i = 0; i < store.size(); ++i) {
    const map::Gaussian& g = store.raw[i];
    useless[i] = !(g.opacity_logit >= least) || !is_finite(g) ? 1 : 0;
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < store.size(); ++i) {
    if (useless[i] != 0) continue;
    notes.pull[kept] = notes.pull[i];
    notes.pixel_m[kept] = notes.pixel_m[i];
    ++kept;
  }
  notes.pull.resize(kept);
  notes.pixel_m.resize(kept);
  harmonics.remove(useless);
  return store.remove_if([&](std::size_t i) { return useless[i] != 0; });
}

std::pair<map::Gaussian, map::Gaussian> halves(const map::Gaussian& whole) {
  // Chosen so that the sum of both is close to the whole: centres half a standard deviation to
  // either side, four fifths of its length.
  constexpr float kOffset = 0.5f, kLength = 0.75f, kOthers = 0.95f;
  const auto axis = std::max_element(whole.log_scale, whole.log_scale + 3) - whole.log_scale;
  const Eigen::Quaternionf q(whole.rotation[0], whole.rotation[1], whole.rotation[2],
                             whole.rotation[3]);
  const Eigen::Vector3f shift = kOffset * std::exp(whole.log_scale[axis]) *
                                q.normalized().toRotationMatrix().col(static_cast<int>(axis));
  map::Gaussian a = whole;
  for (int k = 0; k < 3; ++k) a.log_scale[k] += std::log(k == axis ? kLength : kOthers);
  const float opacity = std::min(map::opacity(whole), 0.999f);
  // What two layers of this opacity let through one of the whole's does.
  a.opacity_logit = logit(std::clamp(1 - std::pow(1 - opacity, 0.6f), 1e-3f, 0.999f));
  map::Gaussian b = a;
  for (int k = 0; k < 3; ++k) {
    a.mean[k] += shift[k];
    b.mean[k] -= shift[k];
  }
  return {a, b};
}

std::size_t split_most_pulled(std::size_t count, double least_sigma_px, map::GaussianStore& store,
                              GaussianNotes& notes, LearnedHarmonics& harmonics) {
  std::vector<std::uint32_t> candidates;
  std::vector<float> wish(store.size(), 0.0f);
  for (std::size_t i = 0; i < store.size(); ++i) {
    const float sigma_px = std::exp(largest_log_scale(store.raw[i])) / notes.pixel_m[i];
    if (!(sigma_px > static_cast<float>(least_sigma_px)) || !(notes.pull[i] > 0)) continue;
    wish[i] = notes.pull[i] * std::sqrt(sigma_px);
    candidates.push_back(static_cast<std::uint32_t>(i));
  }
  count = std::min(count, candidates.size());
  const auto more = [&](std::uint32_t a, std::uint32_t b) {
    return wish[a] != wish[b] ? wish[a] > wish[b] : a < b;
  };
  std::nth_element(candidates.begin(), candidates.begin() + static_cast<std::ptrdiff_t>(count),
                   candidates.end(), more);
  candidates.resize(count);
  // Neighbours in space stay neighbours in memory.
  std::sort(candidates.begin(), candidates.end());
  for (const std::uint32_t i : candidates) {
    const auto [a, b] = halves(store.raw[i]);
    replace(i, a, store);
    store.append(b, store.anchors[i], store.max_log_scale[i]);
    if (!harmonics.empty()) harmonics.split(i);
    notes.pull.push_back(0);
    notes.pixel_m.push_back(notes.pixel_m[i]);
  }
  return count;
}

}  // namespace sgs::refine
