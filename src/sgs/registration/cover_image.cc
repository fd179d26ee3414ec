// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/registration/cover_image.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sgs::registration {
namespace {
constexpr float kNothing = std::numeric_limits<float>::infinity();
}

CoverImage::CoverImage(const CellCamera& camera, int width, int height)
    : camera_(camera),
      width_(width),
      height_(height),
      columns_((width + kSide - 1) / kSide),
      rows_((height + kSide - 1) / kSide),
      farthest_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), kNothing),
      filled_(farthest_.size(), 0) {}

void CoverImage::draw(std::span<const float> depths) {
  constexpr int kEnough = kSide * kSide / 2;  // cells of a square
  std::fill(farthest_.begin(), farthest_.end(), 0.0f);
  std::fill(filled_.begin(), filled_.end(), 0);
  for (int row = 0; row < height_; ++row) {
    for (int column = 0; column < width_; ++column) {
      const float depth = depths[static_cast<std::size_t>(row * width_ + column)];
      const auto square = static_cast<std::size_t>(row / kSide * columns_ + column / kSide);
      if (std::isinf(depth)) continue;
      farthest_[square] = std::max(farthest_[square], depth);
      ++filled_[square];
    }
  }
  for (std::size_t square = 0; square < farthest_.size(); ++square) {
    if (filled_[square] < kEnough) farthest_[square] = kNothing;
  }
}

bool CoverImage::covers(const Eigen::Vector3f& centre, float radius, float margin_m) const {
  constexpr float kSlack = 1e-4f;  // of rounding, relative
  radius += kSlack * (1 + centre.norm());
  const float near = centre.z() - radius, far = centre.z() + radius;
  if (!(near > camera_.near_m)) return false;
  // The square of kSide cells that the lowest or highest value along an axis falls into, the cell
  // beside it included.
  const auto square = [&](float value, float focal, float middle, float depth, int beside,
                          int last) {
    const float cell = std::floor(value / depth * focal + middle) + static_cast<float>(beside);
    return static_cast<int>(std::clamp(cell / kSide, 0.0f, static_cast<float>(last)));
  };
  const auto low = [&](float value, float focal, float middle, int last) {
    return square(value - radius, focal, middle, value < radius ? near : far, -1, last);
  };
  const auto high = [&](float value, float focal, float middle, int last) {
    return square(value + radius, focal, middle, value > -radius ? near : far, 1, last);
  };
  const int left = low(centre.x(), camera_.fx, camera_.cx, columns_ - 1);
  const int right = high(centre.x(), camera_.fx, camera_.cx, columns_ - 1);
  const int top = low(centre.y(), camera_.fy, camera_.cy, rows_ - 1);
  const int bottom = high(centre.y(), camera_.fy, camera_.cy, rows_ - 1);
  for (int row = top; row <= bottom; ++row) {
    for (int column = left; column <= right; ++column) {
      const float farthest = farthest_[static_cast<std::size_t>(row * columns_ + column)];
      if (!(near > farthest + margin_m)) return false;
    }
  }
  return true;
}

}  // namespace sgs::registration
