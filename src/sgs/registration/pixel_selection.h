// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sgs/registration/photometric.h"

namespace sgs::registration {

/// Depths nearer than this are not used for photometric alignment.
inline constexpr float kNearestPixel_m = 0.1f;

struct SelectedPixel {
  int x = -1, y = -1;  ///< of the level
};

/// Centre of a level's pixel in the full image, rounded to a pixel.
int full_pixel(int level_coordinate, int level, int size);

/// The pixel of highest gradient in each block of a pyramid level, row by row of blocks: among
/// those whose `depth` (of the full image) lies between kNearestPixel_m and config.max_depth_m, and
/// whose gradient exceeds the level's threshold. Same pixels for any instruction set.
std::vector<SelectedPixel> select_pixels(const Image<float>& gray, int level,
                                         const DepthImage& depth, const PhotometricConfig& config);

}  // namespace sgs::registration
