// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/core/error.h"
#include "sgs/render/cpu/layout.h"

namespace sgs::render::cpu {

/// Division of an image into tiles, and where a pixel lies in the tiled layout.
struct TileGrid {
  int width = 0, height = 0;
  int tiles_x = 0, tiles_y = 0;

  TileGrid() = default;
  TileGrid(int image_width, int image_height)
      : width(image_width),
        height(image_height),
        tiles_x((image_width + kTileSide - 1) / kTileSide),
        tiles_y((image_height + kTileSide - 1) / kTileSide) {
    SGS_CHECK(tiles_x <= kMaxTilesPerSide && tiles_y <= kMaxTilesPerSide,
              "the image is larger than 8160 pixels on a side");
  }
  int tiles() const { return tiles_x * tiles_y; }

  /// Index of the first channel of pixel (x, y); the next channel is kBlockPixels further.
  std::size_t index(int x, int y, int channels) const {
    const int tile = y / kTileSide * tiles_x + x / kTileSide;
    const int block = y % kTileSide / kBlockSide * kTileBlocks + x % kTileSide / kBlockSide;
    const int lane = y % kBlockSide * kBlockSide + x % kBlockSide;
    return static_cast<std::size_t>(tile) * tile_floats(channels) +
           static_cast<std::size_t>(block * channels * kBlockPixels + lane);
  }
};

}  // namespace sgs::render::cpu
