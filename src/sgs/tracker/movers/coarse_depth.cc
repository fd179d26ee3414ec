// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/tracker/movers/coarse_depth.h"

namespace sgs::tracker {

CoarseDepth::CoarseDepth(const RgbdFrame& taken)
    : frame(taken.index),
      timestamp_s(taken.timestamp_s),
      depth(taken.depth.width() / kStep_px, taken.depth.height() / kStep_px) {
  constexpr int kMiddle = kStep_px / 2;
  const PinholeCamera& full = taken.camera;
  camera = full;
  camera.width = depth.width();
  camera.height = depth.height();
  camera.fx = full.fx / kStep_px;
  camera.fy = full.fy / kStep_px;
  camera.cx = (full.cx - kMiddle) / kStep_px;
  camera.cy = (full.cy - kMiddle) / kStep_px;
  for (int v = 0; v < depth.height(); ++v) {
    const float* row = taken.depth.row(v * kStep_px + kMiddle);
    for (int u = 0; u < depth.width(); ++u) depth(u, v) = row[u * kStep_px + kMiddle];
  }
}

}  // namespace sgs::tracker
