// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "sgs/map/gaussian.h"
#include "sgs/render/cpu/layout.h"
#include "sgs/render/view.h"

namespace sgs::render::cpu {

/// Where a chunk's visible Gaussians go; arrays of at least kChunk elements.
struct ProjectedChunk {
  Record* records;
  std::uint32_t* keys;     ///< depth, quantised, increasing
  TileRect* rects;         ///< copies of the records'
  std::uint32_t* sources;  ///< index of the Gaussian
};
struct ChunkCount {
  std::uint32_t visible = 0, slots = 0;
};

inline constexpr int kKeyBits = 22;

/// Projects `count` <= kChunk Gaussians, the first of them with index `first`, and keeps the
/// visible ones in order.
ChunkCount project_chunk(const View<float>& view, const map::Gaussian* gaussians,
                         std::uint32_t first, std::uint32_t count, const ProjectedChunk& out);

}  // namespace sgs::render::cpu
