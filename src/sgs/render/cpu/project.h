// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "sgs/map/gaussian.h"
#include "sgs/render/cpu/layout.h"
#include "sgs/render/view.h"

namespace sgs::render::cpu {

/// Gaussians to project, and which of them may be left out (see EvaluateOptions; null = none).
struct ProjectJob {
  const map::Gaussian* gaussians = nullptr;  ///< all of them
  const std::uint8_t* frozen = nullptr;
  const std::uint8_t* active_tiles = nullptr;
  int tiles_x = 0;
};

/// Where a chunk's visible Gaussians go; arrays of at least kChunk elements, `first_slot` one more.
struct ProjectedChunk {
  Record* records;
  std::uint32_t* keys;  ///< depth, quantised, increasing
  TileRect* rects;      ///< copies of the records'
  // Of those that are not frozen:
  std::uint32_t* trained;     ///< index of the Gaussian
  std::uint32_t* first_slot;  ///< as in its record; behind the last one, the end of its slots
};
struct ChunkCount {
  std::uint32_t visible = 0, trained = 0, slots = 0;
};

inline constexpr int kKeyBits = 22;

/// Projects the Gaussians `indices`, at most kChunk, and puts the visible ones in order into `out`.
ChunkCount project_chunk(const View<float>& view, const ProjectJob& job,
                         std::span<const std::uint32_t> indices, const ProjectedChunk& out);

}  // namespace sgs::render::cpu
