// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/alignment/movers/coarse_depth.h"

#include <algorithm>

namespace sgs::alignment {
namespace {

constexpr int kWidth_px = 160;

}  // namespace

CoarseDepth::CoarseDepth(const RgbdFrame& taken)
    : step_px(std::max(1, taken.depth.width() / kWidth_px)),
      frame(taken.index),
      timestamp_s(taken.timestamp_s),
      depth(taken.depth.width() / step_px, taken.depth.height() / step_px) {
  const int middle = step_px / 2;
  const PinholeCamera& full = taken.camera;
  camera = full;
  camera.width = depth.width();
  camera.height = depth.height();
  camera.fx = full.fx / step_px;
  camera.fy = full.fy / step_px;
  camera.cx = (full.cx - middle) / step_px;
  camera.cy = (full.cy - middle) / step_px;
  for (int v = 0; v < depth.height(); ++v) {
    const float* row = taken.depth.row(v * step_px + middle);
    for (int u = 0; u < depth.width(); ++u) depth(u, v) = row[u * step_px + middle];
  }
}

SE3 between_depths(const CoarseDepth& now, const CoarseDepth& then, const SE3& T_then_now) {
  return SE3::exp(Vector6d(-then.motion.lag())) * T_then_now * SE3::exp(now.motion.lag());
}

}  // namespace sgs::alignment
