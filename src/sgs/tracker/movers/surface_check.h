// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sgs/geometry/se3.h"
#include "sgs/tracker/movers/coarse_view.h"

namespace sgs::tracker {

/// How far surface of a view is from where an older view saw it, cell by cell.
struct SurfaceCheck {
  static constexpr int kCell = 2;  ///< pixels of the coarse view to a cell's side
  static constexpr float kUnknown = -1;

  int columns = 0, rows = 0;
  /// 0 (as the noise has it) .. 1 (many widths off, or where nothing stood), or kUnknown: not
  /// measured, out of sight, or hidden then.
  std::vector<float> off;
  /// Sum of 1 - off over what is known: how much of the picture the pose explains.
  double support = 0;
};

/// Checks `view` against `past`, which saw from `T_past_view` (view's camera to past's). `sigma`:
/// noise of a grey value of the views.
SurfaceCheck check_surface(const CoarseView& view, const CoarseView& past, const SE3& T_past_view,
                           double sigma);

}  // namespace sgs::tracker
