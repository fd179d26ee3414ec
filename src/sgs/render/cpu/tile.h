// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sgs/render/cpu/buffer.h"
#include "sgs/render/cpu/layout.h"

namespace sgs::render::cpu {

/// Gaussians of a tile are composited in batches of this many; a multiple of any vector's lanes.
inline constexpr std::uint32_t kBatch = 1024;
/// Distance between the lists of two blocks; not a multiple of 4 KiB, which would map the heads of
/// all lists to the same cache set.
inline constexpr std::uint32_t kListStride = kBatch + 16;

/// A Gaussian as the inner loops of a tile read it.
struct alignas(64) Staged {
  float x, y;  ///< tile origin minus mean
  float A, B, C, log2_opacity;
  float r, g, b, z;
  float unused[6];
};

/// Forward state of a block of 16 pixels.
struct alignas(64) BlockState {
  float T[kBlockPixels], r[kBlockPixels], g[kBlockPixels], b[kBlockPixels], d[kBlockPixels],
      a[kBlockPixels];
};

/// Backward state: loss gradients of the pixels, transmittance in front of the present Gaussian,
/// and S = sum of w (g . value) of it and everything behind it.
struct alignas(64) BlockGradient {
  float r[kBlockPixels], g[kBlockPixels], b[kBlockPixels], d[kBlockPixels], a[kBlockPixels],
      T[kBlockPixels], S[kBlockPixels];
  float nearest_z[kBlockPixels];  ///< Gaussians in front of this get no gradient
};

/// Working memory of one thread.
struct TileScratch {
  Buffer<Staged> staged;              // the tile's Gaussians
  Buffer<std::uint32_t> active[2];    // blocks 0-31 and 32-63 in which each was composited
  Buffer<std::uint32_t> slots;        // where the sums of the Gaussian go
  Buffer<std::uint32_t> block_list;   // [block][kListStride]: Gaussians of the batch that touch it
  Buffer<float> alphas;               // 16 per (batch, block, Gaussian), in this order
  Buffer<std::uint32_t> alpha_start;  // per (batch, block)
  BlockState state[kBlocksPerTile];
  BlockGradient gradient[kBlocksPerTile];
};

/// One visit of a tile: forward, and with `training` also loss and backward.
struct TileJob {
  const Record* records = nullptr;
  std::span<const std::uint32_t> entries;  ///< record indices, nearest first
  int tile_x = 0, tile_y = 0;
  int width = 0, height = 0;              ///< image, pixels
  float* image = nullptr;                 ///< this tile's kImageChannels, or null
  const float* training = nullptr;        ///< this tile's kTrainingChannels
  const float* color_gradient = nullptr;  ///< added to the colour gradient, or null
  TileLoss loss;
  float min_transmittance = 0;               ///< compositing stops here
  const std::uint32_t* slot_base = nullptr;  ///< first slot of each chunk
  SumRow* slots = nullptr;
  std::uint8_t* slot_used = nullptr;  ///< kSlotUsed or kSlotReached; 0 before
  bool note_reached = false;          ///< tell kSlotReached by `reached_weight`
  float reached_weight = 0;
  TileResult* result = nullptr;
};

void process_tile(const TileJob& job, TileScratch& scratch);

}  // namespace sgs::render::cpu
