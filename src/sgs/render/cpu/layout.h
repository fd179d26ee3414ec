// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

/// Data layouts that the stages of the CPU rasterizer share. Plain data: this header is seen by
/// code compiled for different instruction sets and therefore holds no functions that do work.
namespace sgs::render::cpu {

inline constexpr int kBlockSide = 4;  ///< pixels; a block is what one AVX-512 vector holds
inline constexpr int kBlockPixels = 16;
inline constexpr int kTileBlocks = 8;         ///< blocks per tile side
inline constexpr int kTileSide = 32;          ///< pixels
inline constexpr int kBlocksPerTile = 64;     ///< one bit each of a 64-bit mask
inline constexpr int kMaxTilesPerSide = 255;  ///< a tile coordinate fits a byte
inline constexpr int kImageChannels = 5;      ///< r g b depth-sum alpha
inline constexpr int kTrainingChannels = 4;   ///< r g b depth
inline constexpr int kGradientChannels = 3;   ///< r g b

/// Images are stored tile by tile (row-major), block by block, channel by channel, 16 pixels of a
/// channel together: floats per tile for a number of channels.
constexpr std::size_t tile_floats(int channels) {
  return static_cast<std::size_t>(kBlocksPerTile * kBlockPixels) *
         static_cast<std::size_t>(channels);
}

/// Gaussians are projected in chunks of this many; chunk boundaries never depend on the number of
/// threads. A record's index is chunk * kChunk + rank among the visible of the chunk.
inline constexpr std::uint32_t kChunkShift = 11;
inline constexpr std::uint32_t kChunk = 1u << kChunkShift;

/// Tiles that a Gaussian's box touches, inclusive.
struct TileRect {
  std::uint8_t x0, y0, x1, y1;
};

/// A visible Gaussian as the tiles read it: one cache line.
struct alignas(64) Record {
  float x, y;     ///< mean, pixels
  float A, B, C;  ///< log2 alpha = log2_opacity + A dx^2 + B dx dy + C dy^2
  float log2_opacity;
  float r, g, b, z;
  float extent_x, extent_y;  ///< half box outside which alpha < 1/255, pixels
  TileRect rect;
  std::uint32_t slot;  ///< first slot of its (Gaussian, tile) sums, relative to its chunk
  float tilt;          ///< y / x at the ellipse's rightmost point: cov_xy / cov_xx
  float half_width2;   ///< squared half width of the ellipse at y = 0
};
static_assert(sizeof(Record) == 64);

/// What is noted of a slot: it holds sums; and its Gaussian weighs enough in one of the pixels.
inline constexpr std::uint8_t kSlotUsed = 1, kSlotReached = 3;

/// The ten sums over the pixels of one (Gaussian, tile) instance; which lane holds which sum is a
/// matter of the instruction set (see reduce-inl.h).
struct alignas(64) SumRow {
  float lane[16];
};

/// Stands for a knee of 0: no residual but zero is below it.
inline constexpr float kLeastKnee = 1e-20f;

/// LossConfig in the form of the tile kernel.
struct TileLoss {
  float color_weight = 0;  ///< per channel
  float depth_weight = 0;
  float color_knee = kLeastKnee, depth_knee_m = kLeastKnee;
  float gain[3] = {1, 1, 1};
  float floater_margin_m = 0;
  bool depth_relative = true;
  bool color_only_where_depth = false;
};

/// What a tile contributes to sums over the image.
struct TileResult {
  double loss;
  double exposure_measured[3];
  double exposure_rendered[3];
};

}  // namespace sgs::render::cpu
