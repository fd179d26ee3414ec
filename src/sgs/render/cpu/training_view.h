// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <mutex>

#include "sgs/render/cpu/buffer.h"
#include "sgs/render/cpu/ssim.h"
#include "sgs/render/cpu/tiled_image.h"
#include "sgs/render/rasterizer.h"

namespace sgs::render::cpu {

/// A training image in tiled layout (kTrainingChannels, zero outside the image and, but for
/// depth, where the camera saw nothing), and on first
/// demand the window moments that D-SSIM compares with.
class CpuTrainingView final : public TrainingView {
 public:
  explicit CpuTrainingView(const TrainingImage& image);

  const TileGrid& grid() const { return grid_; }
  const float* tile(int t) const {
    return pixels_.data() + static_cast<std::size_t>(t) * tile_floats(kTrainingChannels);
  }
  bool all_seen() const { return all_seen_; }
  bool seen(int x, int y) const {
    return pixels_[grid_.index(x, y, kTrainingChannels) + 3 * kBlockPixels] >= 0;
  }
  /// One per channel; thread-safe.
  const std::array<MeasuredMoments, 3>& moments() const;

 private:
  TileGrid grid_;
  Buffer<float> pixels_;
  bool all_seen_ = true;
  mutable std::once_flag moments_once_;
  mutable std::array<MeasuredMoments, 3> moments_;
};

}  // namespace sgs::render::cpu
