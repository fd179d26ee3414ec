// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sgs/alignment/movers/coarse_depth.h"
#include "sgs/geometry/se3.h"

namespace sgs::alignment {

/// Whether surface of a frame is where an older one saw it, cell by cell.
struct SurfaceCheck {
  static constexpr int kCell = 2;  ///< pixels of the coarse depth to a cell's side
  static constexpr float kUnknown = -1;

  int columns = 0;
  /// 0 (as noise has it) .. 1 (three widths off or more: where nothing stood), or kUnknown: not
  /// measured, out of sight, or behind what was seen there, and so perhaps hidden by it.
  std::vector<float> off;
  /// Sum of 1 - off over what is known: how much of the older frame the pose explains.
  double support = 0;
};

struct CheckOptions {
  /// Depth may be measured so much sooner or later than is known, while the camera moves.
  double clock_s = 0;
  /// Depth is so many times as noisy as its model says.
  double noise_ratio = 1;
  int stride = 1;  ///< one cell is asked of so many, across and down; the others are unknown
};

/// Checks `now` against `then`, where the camera of now's depth stood so in then's
/// (between_depths()).
SurfaceCheck check_surface(const CoarseDepth& now, const CoarseDepth& then, const SE3& T_then_now,
                           const CheckOptions& options = {});

/// As near as the sensor measures, going by one frame: hardly anything of it is nearer. Metres;
/// infinite where nothing is measured.
float nearest_measured(const CoarseDepth& frame);

/// Sets `off` (SurfaceCheck::off) to 1 where nothing is measured far and wide of now, although
/// then's surface stands there and no nearer than now's nearest_measured(): something that is too
/// near, or of which the sensor sees nothing, is before it. Where nothing was measured then either
/// (a rim, a window) is left as it is.
void check_covered(const CoarseDepth& now, const CoarseDepth& then, const SE3& T_then_now,
                   float nearest_m, std::vector<float>& off);

}  // namespace sgs::alignment
