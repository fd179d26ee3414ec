// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/render/cpu/training_view.h"

#include <algorithm>

namespace sgs::render::cpu {

CpuTrainingView::CpuTrainingView(const TrainingImage& image)
    : TrainingView(image.camera), grid_(image.camera.width, image.camera.height) {
  const std::size_t size = static_cast<std::size_t>(grid_.tiles()) * tile_floats(kTrainingChannels);
  pixels_.ensure_exactly(size);
  const bool padded = grid_.width % kTileSide != 0 || grid_.height % kTileSide != 0;
  if (padded) std::fill_n(pixels_.data(), size, 0.0f);
  for (int row = 0; row < grid_.tiles_y; ++row) {
    for_each_run(grid_, row, kTrainingChannels, [&](int x, int y, int n, std::size_t index) {
      float* p = pixels_.data() + index;
      const Rgbf* c = image.color.row(y) + x;
      const float* z = image.depth.row(y) + x;
      for (int i = 0; i < n; ++i) {
        if (z[i] < 0) {  // as the space around the image
          all_seen_ = false;
          p[i] = p[kBlockPixels + i] = p[2 * kBlockPixels + i] = 0;
          p[3 * kBlockPixels + i] = z[i];
          continue;
        }
        p[i] = c[i].r;
        p[kBlockPixels + i] = c[i].g;
        p[2 * kBlockPixels + i] = c[i].b;
        p[3 * kBlockPixels + i] = z[i];
      }
    });
  }
}

const std::array<MeasuredMoments, 3>& CpuTrainingView::moments() const {
  std::call_once(moments_once_, [this] {
    for (std::size_t c = 0; c < 3; ++c) {
      PaddedPlane plane(grid_.width, grid_.height);
      for (int y = 0; y < grid_.height; ++y) {
        for (int x = 0; x < grid_.width; ++x) {
          plane.row(y)[x] = pixels_[grid_.index(x, y, kTrainingChannels) + c * kBlockPixels];
        }
      }
      moments_[c] = MeasuredMoments(std::move(plane));
    }
  });
  return moments_;
}

}  // namespace sgs::render::cpu
