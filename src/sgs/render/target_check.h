// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/render/rasterizer.h"

namespace sgs::render {

/// Throws unless camera, colour and depth belong together.
inline void check_training_image(const TrainingImage& image) {
  SGS_CHECK(image.camera.valid(), "the camera must be valid");
  SGS_CHECK(
      image.color.width() == image.camera.width && image.color.height() == image.camera.height,
      "colour and camera must have the same size");
  SGS_CHECK(
      image.depth.width() == image.camera.width && image.depth.height() == image.camera.height,
      "depth and camera must have the same size");
}

/// Throws unless the options fit the number of Gaussians, the camera, the loss and one another.
inline void check_options(const EvaluateOptions& options, std::size_t gaussians,
                          const PinholeCamera& camera, const LossConfig& loss) {
  const auto tiles_along = [](int pixels) {
    return static_cast<std::size_t>((pixels + kMaskTile - 1) / kMaskTile);
  };
  SGS_CHECK(options.bounds == nullptr || options.bounds->size() == gaussians,
            "the bounds belong to other Gaussians");
  SGS_CHECK(options.frozen.empty() || options.frozen.size() == gaussians,
            "`frozen` needs one entry per Gaussian");
  SGS_CHECK(options.candidates == nullptr || options.candidates->size() <= gaussians,
            "the candidates belong to other Gaussians");
  SGS_CHECK(options.reached == nullptr || options.frozen.empty(),
            "which Gaussians were reached is not known of frozen ones");
  SGS_CHECK(options.reached_weight >= 0 && options.reached_weight < 1,
            "the least weight must lie between 0 and 1");
  SGS_CHECK(options.min_transmittance > 0 && options.min_transmittance < 1,
            "the least transmittance must lie between 0 and 1");
  if (options.tiles.empty()) return;
  SGS_CHECK(options.tiles.size() == tiles_along(camera.width) * tiles_along(camera.height),
            "`tiles` needs one entry per tile");
  SGS_CHECK(options.rendering == nullptr && loss.dssim_weight == 0.0f,
            "a tile mask goes neither with a rendering nor with D-SSIM");
}

}  // namespace sgs::render
