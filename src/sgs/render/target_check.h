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

}  // namespace sgs::render
