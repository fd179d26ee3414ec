// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/tracker/movers/coarse_view.h"

#include <algorithm>

namespace sgs::tracker {

CoarseView CoarseView::of(const RgbdFrame& frame, const GrayPyramid& pyramid) {
  const int level = std::min(kLevel, pyramid.levels() - 1);
  CoarseView view;
  view.frame = frame.index;
  view.timestamp_s = frame.timestamp_s;
  view.camera = pyramid.level(level).camera;
  view.step_px = 1 << level;
  view.gray = pyramid.level(level).gray;
  view.depth = DepthImage(view.gray.width(), view.gray.height());
  const int middle = view.step_px / 2;
  for (int v = 0; v < view.depth.height(); ++v) {
    const float* row = frame.depth.row(v * view.step_px + middle);
    for (int u = 0; u < view.depth.width(); ++u) view.depth(u, v) = row[u * view.step_px + middle];
  }
  return view;
}

}  // namespace sgs::tracker
