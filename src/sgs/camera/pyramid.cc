// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/camera/pyramid.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sgs/camera/luma_row.h"

namespace sgs {
namespace {

constexpr int kMinSide = 8;
constexpr float kUnseen = std::numeric_limits<float>::quiet_NaN();

void halve_row(const float* upper, const float* lower, float* out, int width) {
  for (int x = 0; x < width; ++x) {
    out[x] = 0.25f * ((upper[2 * x] + upper[2 * x + 1]) + (lower[2 * x] + lower[2 * x + 1]));
  }
}

// The same where some pixels are NaN.
void halve_seen_row(const float* upper, const float* lower, float* out, int width) {
  constexpr int kLeast = 2;
  for (int x = 0; x < width; ++x) {
    float sum = 0;
    int seen = 0;
    for (const float* p : {upper + 2 * x, lower + 2 * x}) {
      for (int i = 0; i < 2; ++i) {
        if (std::isnan(p[i])) continue;
        sum += p[i];
        ++seen;
      }
    }
    out[x] = seen >= kLeast ? sum / static_cast<float>(seen) : kUnseen;
  }
}

template <class T>
void ensure_size(Image<T>& image, int width, int height) {
  if (image.width() != width || image.height() != height) image = Image<T>(width, height);
}

}  // namespace

void GrayPyramid::prepare(const PinholeCamera& camera, int levels) {
  SGS_CHECK(levels >= 1, "a pyramid has at least one level");
  int usable = 1;
  while (usable < levels && std::min(camera.width >> usable, camera.height >> usable) >= kMinSide) {
    ++usable;
  }
  levels_.resize(static_cast<std::size_t>(usable));
  for (int k = 0; k < usable; ++k) {
    Level& level = levels_[static_cast<std::size_t>(k)];
    level.camera = camera.halved(k);
    ensure_size(level.gray, level.camera.width, level.camera.height);
  }
}

void GrayPyramid::build_coarse_levels(bool all_seen) {
  const auto halve = all_seen ? halve_row : halve_seen_row;
  for (std::size_t k = 1; k < levels_.size(); ++k) {
    const Image<float>& fine = levels_[k - 1].gray;
    Level& level = levels_[k];
    for (int y = 0; y < level.gray.height(); ++y) {
      halve(fine.row(2 * y), fine.row(2 * y + 1), level.gray.row(y), level.gray.width());
    }
  }
}

void GrayPyramid::build(const ColorImage& color, const PinholeCamera& camera, int levels,
                        const PixelMask* seen) {
  SGS_CHECK(color.width() == camera.width && color.height() == camera.height,
            "image and camera differ in size");
  SGS_CHECK(color.width() >= 3 && color.height() >= 3, "image too small for gradients");
  prepare(camera, levels);
  Level& top = levels_.front();
  for (int y = 0; y < color.height(); ++y) {
    luma_row(color.row(y), top.gray.row(y), static_cast<std::size_t>(color.width()));
  }
  for (std::size_t i = 0; seen && i < seen->size(); ++i) {
    if (seen->data()[i] == 0) top.gray.data()[i] = kUnseen;
  }
  build_coarse_levels(seen == nullptr);
}

void GrayPyramid::build(const Image<float>& gray, const PinholeCamera& camera, int levels) {
  SGS_CHECK(gray.width() == camera.width && gray.height() == camera.height,
            "image and camera differ in size");
  SGS_CHECK(gray.width() >= 3 && gray.height() >= 3, "image too small for gradients");
  prepare(camera, levels);
  Level& top = levels_.front();
  for (int y = 0; y < gray.height(); ++y) {
    std::copy_n(gray.row(y), gray.width(), top.gray.row(y));
  }
  build_coarse_levels(true);
}

}  // namespace sgs
