// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "sgs/map/gaussian.h"
#include "sgs/render/cpu/layout.h"
#include "sgs/render/view.h"

namespace sgs::render::cpu {

/// Where a chunk's visible Gaussians go; arrays of at least kChunk elements, `first_slot` one more.
struct ProjectedChunk {
  Record* records;
  std::uint32_t* keys;        ///< depth, quantised, increasing
  TileRect* rects;            ///< copies of the records'
  std::uint32_t* sources;     ///< index of the Gaussian
  std::uint32_t* first_slot;  ///< as in its record; behind the last one, the end of its slots
};
struct ChunkCount {
  std::uint32_t visible = 0, slots = 0;
};

inline constexpr int kKeyBits = 22;

/// Projects those of `gaussians` (all of them) that `indices` lists, at most kChunk, and puts the
/// visible ones in order into `out`.
ChunkCount project_chunk(const View<float>& view, const map::Gaussian* gaussians,
                         std::span<const std::uint32_t> indices, const ProjectedChunk& out);

}  // namespace sgs::render::cpu
