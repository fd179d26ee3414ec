// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "sgs/map/gaussian.h"
#include "sgs/render/cpu/layout.h"
#include "sgs/render/view.h"

namespace sgs::render::cpu {

/// Rows behind the last used one of `slots` that are asked for ahead of time, never used.
inline constexpr std::uint32_t kSlotsReadAhead = 34;

/// From the per-tile sums of some visible Gaussians of a chunk to gradients
/// of their parameters.
struct SplatBackwardJob {
  const map::Gaussian* gaussians = nullptr;   ///< all of them
  const std::uint32_t* sources = nullptr;     ///< index per visible Gaussian
  const std::uint32_t* first_slot = nullptr;  ///< per visible Gaussian, and the end of the last's
  std::uint32_t visible = 0;
  const SumRow* slots = nullptr;  ///< the chunk's
  const std::uint8_t* slot_used = nullptr;
  map::Gaussian* gradient = nullptr;  ///< one row per visible Gaussian
  double* twist = nullptr;            ///< 6; their share of the camera gradient is added
};

void splat_backward_chunk(const View<float>& view, const SplatBackwardJob& job);

}  // namespace sgs::render::cpu
