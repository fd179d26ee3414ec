// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/tracker/known_view.h"

#include <utility>

#include "sgs/camera/resample.h"

namespace sgs::tracker {

RgbdFrame seen_from(const KnownView& view, const PinholeCamera& camera) {
  RgbdFrame frame = view.view.frame();
  if (frame.camera == camera) return frame;
  auto seen = seen_by(frame.camera, camera);
  frame.color = resample_color(frame.color, frame.camera, camera);
  frame.depth = resample_depth(frame.depth, frame.camera, camera);
  // A mask of the view's own is lost with its borders; they are few.
  frame.seen = std::move(seen);
  frame.camera = camera;
  return frame;
}

}  // namespace sgs::tracker
