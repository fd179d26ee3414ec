// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

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

/// Calls `body(x, y, n, index)` for every run of n <= 4 pixels from (x, y) rightwards in one row of
/// tiles; they lie at `index`, index + 1, ... of each channel.
template <class Body>
void for_each_run(const TileGrid& grid, int tile_row, int channels, const Body& body) {
  const int y1 = std::min(grid.height, (tile_row + 1) * kTileSide);
  for (int y = tile_row * kTileSide; y < y1; ++y) {
    for (int tile_x = 0; tile_x < grid.tiles_x; ++tile_x) {
      const int x0 = tile_x * kTileSide;
      std::size_t index = grid.index(x0, y, channels);
      const int x1 = std::min(grid.width, x0 + kTileSide);
      for (int x = x0; x < x1; x += kBlockSide) {
        body(x, y, std::min(kBlockSide, grid.width - x), index);
        index += static_cast<std::size_t>(channels * kBlockPixels);
      }
    }
  }
}

}  // namespace sgs::render::cpu
