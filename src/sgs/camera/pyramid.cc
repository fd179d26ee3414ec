// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/camera/pyramid.h"

#include <algorithm>

#include "sgs/camera/luma_row.h"

namespace sgs {
namespace {

constexpr int kMinSide = 8;

void halve_row(const float* upper, const float* lower, float* out, int width) {
  for (int x = 0; x < width; ++x) {
    out[x] = 0.25f * ((upper[2 * x] + upper[2 * x + 1]) + (lower[2 * x] + lower[2 * x + 1]));
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

void GrayPyramid::build_coarse_levels() {
  for (std::size_t k = 1; k < levels_.size(); ++k) {
    const Image<float>& fine = levels_[k - 1].gray;
    Level& level = levels_[k];
    for (int y = 0; y < level.gray.height(); ++y) {
      halve_row(fine.row(2 * y), fine.row(2 * y + 1), level.gray.row(y), level.gray.width());
    }
  }
}

void GrayPyramid::build(const ColorImage& color, const PinholeCamera& camera, int levels) {
  SGS_CHECK(color.width() == camera.width && color.height() == camera.height,
            "image and camera differ in size");
  SGS_CHECK(color.width() >= 3 && color.height() >= 3, "image too small for gradients");
  prepare(camera, levels);
  Level& top = levels_.front();
  for (int y = 0; y < color.height(); ++y) {
    luma_row(color.row(y), top.gray.row(y), static_cast<std::size_t>(color.width()));
  }
  build_coarse_levels();
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
  build_coarse_levels();
}

}  // namespace sgs
