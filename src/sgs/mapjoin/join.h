// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>

#include "sgs/core/thread_pool.h"
#include "sgs/mapjoin/part.h"
#include "sgs/mapjoin/tie_finder.h"

namespace sgs::mapjoin {

/// What became of joining one map to another.
struct Outcome {
  bool joined = false;
  Search search;
  std::size_t agreed = 0, rival = 0;  ///< ties that say one thing, and the most that say another
  int expected = 0, confirmed = 0;    ///< views that should see the base, and those that do
  std::size_t ties = 0;               ///< in the graph in the end
  std::size_t merged = 0;             ///< Gaussians that became one with others
  std::size_t dropped = 0;            ///< that hung in the air, as the other map saw
  std::array<float, 3> colours = {1, 1, 1};  ///< by which those of the other were multiplied
  SE3 T_base_other;             ///< where the world of the other lies in that of the base
  std::optional<double> metre;  ///< depth of the other over that of the base

  /// Why it was not joined and how near it came, or how it was.
  std::string sentence() const;
};

/// `base` with `other` in its world; as it was where `other` is not found there for sure. The same
/// bits for any number of threads.
Outcome join(Part& base, const Part& other, ThreadPool& pool);

}  // namespace sgs::mapjoin
