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

/// Throws unless the options fit the number of Gaussians.
inline void check_options(const EvaluateOptions& options, std::size_t gaussians) {
  const auto& [bounds, candidates, min_transmittance] = options.scope;
  SGS_CHECK(bounds == nullptr || bounds->size() == gaussians,
            "the bounds belong to other Gaussians");
  SGS_CHECK(candidates == nullptr || candidates->size() <= gaussians,
            "the candidates belong to other Gaussians");
  SGS_CHECK(min_transmittance > 0 && min_transmittance < 1,
            "the least transmittance must lie between 0 and 1");
  SGS_CHECK(options.capture.reached_weight >= 0 && options.capture.reached_weight < 1,
            "the least weight must lie between 0 and 1");
}

}  // namespace sgs::render
