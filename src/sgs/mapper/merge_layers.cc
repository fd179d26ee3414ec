// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapper/merge_layers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "sgs/core/error.h"

namespace sgs::mapper {
namespace {

/// How far a Gaussian reaches along its surface, metres: the larger of its three deviations.
float reach_of(const map::Gaussian& g) {
  return std::exp(std::max({g.log_scale[0], g.log_scale[1], g.log_scale[2]}));
}

Eigen::Vector3f mean_of(const map::Gaussian& g) { return {g.mean[0], g.mean[1], g.mean[2]}; }

/// Gaussians by place and size: cells of one size hold those whose reach lies between a quarter
/// and a half of it, so that those close to one are found in eight cells of each size.
class Cells {
 public:
  explicit Cells(std::size_t most) : heads_(table_size(most), -1), next_(most, -1) {}

  void add(std::size_t index, const Eigen::Vector3f& mean, float reach) {
    const int level = level_of(reach);
    std::int32_t& head = heads_[slot(level, cell_of(mean, level))];
    next_[index] = head;
    head = static_cast<std::int32_t>(index);
  }
  /// Calls `visit(index)` for all that may lie within a reach of `mean` and are at most about twice
  /// as large or small, and for some others.
  template <class Visit>
  void visit_near(const Eigen::Vector3f& mean, float reach, const Visit& visit) const {
    const int own = level_of(reach);
    for (int level = own - 1; level <= own + 1; ++level) {
      const float size = std::ldexp(1.0f, level);
      const Eigen::Array3f lowest = (mean / size).array() - 0.5f;
      const Eigen::Array3i low = lowest.floor().cast<int>();
      std::array<std::size_t, 8> slots;
      for (std::size_t corner = 0; corner < 8; ++corner) {
        const auto bit = [&](int k) { return static_cast<int>(corner >> k & 1); };
        slots[corner] = slot(level, low + Eigen::Array3i(bit(0), bit(1), bit(2)));
      }
      // Two cells may share a slot of the table.
      std::sort(slots.begin(), slots.end());
      const auto end = std::unique(slots.begin(), slots.end());
      for (auto s = slots.begin(); s != end; ++s) {
        for (std::int32_t i = heads_[*s]; i >= 0; i = next_[static_cast<std::size_t>(i)]) {
          visit(static_cast<std::size_t>(i));
        }
      }
    }
  }

 private:
  static std::size_t table_size(std::size_t most) {
    std::size_t size = 1024;
    while (size < 2 * most) size *= 2;
    return size;
  }
  static int level_of(float reach) { return static_cast<int>(std::ceil(std::log2(2 * reach))); }
  static Eigen::Array3i cell_of(const Eigen::Vector3f& mean, int level) {
    return (mean / std::ldexp(1.0f, level)).array().floor().cast<int>();
  }
  std::size_t slot(int level, const Eigen::Array3i& cell) const {
    std::uint64_t h = static_cast<std::uint64_t>(level + 64);
    for (int k = 0; k < 3; ++k) {
      h = (h ^ static_cast<std::uint32_t>(cell[k])) * 0x9e3779b97f4a7c15u;
      h ^= h >> 32;
    }
    return h & (heads_.size() - 1);
  }

  std::vector<std::int32_t> heads_, next_;
};

/// By what a correction moved two keyframes differently, at a point that both see.
class Apart {
 public:
  explicit Apart(std::span<const SE3> moves) {
    for (const SE3& T : moves) back_.push_back(T.inverse());
  }
  /// Distance between where the two layers had a point that is now at `p`, metres.
  float distance(std::int32_t a, std::int32_t b, const Eigen::Vector3f& p) const {
    const Eigen::Vector3d q = p.cast<double>();
    return static_cast<float>(
        (back_[static_cast<std::size_t>(a)] * q - back_[static_cast<std::size_t>(b)] * q).norm());
  }

 private:
  std::vector<SE3> back_;
};

/// How well the newer fits on the older, as a squared distance in units of what is allowed; more
/// than 1: it does not.
float misfit(const map::GaussianStore& store, std::size_t older, std::size_t newer,
             const MergeConfig& config) {
  constexpr float kLeastCosine = 0.9f, kMostRatio = 2;
  constexpr float kNone = 2;
  const map::Gaussian& a = store.raw[older];
  const map::Gaussian& b = store.raw[newer];
  const map::Anchor& anchor = store.anchors[older];
  if (!(anchor.normal.dot(store.anchors[newer].normal) > kLeastCosine)) return kNone;
  const float reach_a = reach_of(a), reach_b = reach_of(b);
  if (!(reach_a < kMostRatio * reach_b && reach_b < kMostRatio * reach_a)) return kNone;
  for (int k = 0; k < 3; ++k) {
    if (!(std::abs(a.rgb[k] - b.rgb[k]) < static_cast<float>(config.color))) return kNone;
  }
  const Eigen::Vector3f between = mean_of(b) - mean_of(a);
  const float across = between.dot(anchor.normal);
  const float along2 = std::max(0.0f, between.squaredNorm() - across * across);
  const float most_along = static_cast<float>(config.distance) * std::min(reach_a, reach_b);
  const float sigma_a = anchor.sigma_n_m, sigma_b = store.anchors[newer].sigma_n_m;
  const float most_across2 = 4 * (sigma_a * sigma_a + sigma_b * sigma_b) + most_along * most_along;
  return along2 / (most_along * most_along) + across * across / most_across2;
}

/// `into` becomes what both show.
void merge(const map::Gaussian& from, map::Gaussian& into) {
  const float a = map::opacity(into), b = map::opacity(from);
  const float share = b / std::max(a + b, 1e-6f);
  for (int k = 0; k < 3; ++k) {
    into.mean[k] += share * (from.mean[k] - into.mean[k]);
    into.rgb[k] += share * (from.rgb[k] - into.rgb[k]);
    into.log_scale[k] += share * (from.log_scale[k] - into.log_scale[k]);
  }
  constexpr float kMostOpaque = 0.99f;  // a logit of 1 would be endless
  const float both = std::min(1 - (1 - a) * (1 - b), kMostOpaque);
  into.opacity_logit =
      std::max({into.opacity_logit, from.opacity_logit, std::log(both / (1 - both))});
}

}  // namespace

std::size_t merge_layers(std::span<const SE3> moves, const MergeConfig& config,
                         map::GaussianStore& store, map::GaussianSet& removed) {
  removed.clear(store.size());
  const Apart apart(moves);
  Cells cells(store.size());
  const auto least = static_cast<float>(config.apart_m);
  std::size_t merged = 0;
  for (std::size_t i = 0; i < store.size(); ++i) {
    const map::Anchor& anchor = store.anchors[i];
    const Eigen::Vector3f mean = mean_of(store.raw[i]);
    const float reach = reach_of(store.raw[i]);
    if (anchor.keyframe < 0 || !mean.allFinite() || !std::isfinite(reach) || reach <= 0) continue;
    SGS_CHECK(static_cast<std::size_t>(anchor.keyframe) < moves.size(), "a move for each keyframe");
    float best = 1;
    std::size_t older = store.size();
    cells.visit_near(mean, reach, [&](std::size_t k) {
      const std::int32_t keyframe = store.anchors[k].keyframe;
      if (keyframe == anchor.keyframe) return;
      const float fit = misfit(store, k, i, config);
      if (!(fit < best || (fit == best && k < older))) return;
      if (!(apart.distance(keyframe, anchor.keyframe, mean) > least)) return;
      best = fit;
      older = k;
    });
    if (older == store.size()) {
      cells.add(i, mean, reach);
      continue;
    }
    merge(store.raw[i], store.raw[older]);
    merge(store.average[i], store.average[older]);
    removed.insert(i);
    ++merged;
  }
  return merged;
}

}  // namespace sgs::mapper
