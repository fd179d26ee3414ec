// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace sgs {

/// Every n-th frame is kept from the mapper, so that its picture can judge the map (evaluation rule
/// `heldout`).
inline constexpr int kHeldoutInterval = 8;

/// True for frames that only evaluation may use: `index` % interval == interval / 2 (frames 4, 12,
/// 20, ... by default). `interval` <= 0 holds nothing out. Defined here because the caller of the
/// mapper and the evaluator must agree.
inline bool is_heldout(std::int64_t index, int interval = kHeldoutInterval) {
  return interval > 0 && index % interval == interval / 2;
}

}  // namespace sgs
