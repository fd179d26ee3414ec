// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/camera/pinhole.h"
#include "sgs/geometry/se3.h"

namespace sgs::render {

/// Fills a View (splat_math.inl) from camera and pose.
template <class ViewT>
ViewT make_view(const PinholeCamera& camera, const SE3& T_world_camera) {
  using S = decltype(ViewT::fx);
  ViewT view;
  view.fx = static_cast<S>(camera.fx);
  view.fy = static_cast<S>(camera.fy);
  view.cx = static_cast<S>(camera.cx);
  view.cy = static_cast<S>(camera.cy);
  view.width = static_cast<S>(camera.width);
  view.height = static_cast<S>(camera.height);
  const SE3 T_camera_world = T_world_camera.inverse();
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) view.R[3 * r + c] = static_cast<S>(T_camera_world.R(r, c));
    view.t[r] = static_cast<S>(T_camera_world.t(r));
  }
  view.u_min = static_cast<S>((-0.15 * camera.width - camera.cx) / camera.fx);
  view.u_max = static_cast<S>((1.15 * camera.width - camera.cx) / camera.fx);
  view.v_min = static_cast<S>((-0.15 * camera.height - camera.cy) / camera.fy);
  view.v_max = static_cast<S>((1.15 * camera.height - camera.cy) / camera.fy);
  return view;
}

}  // namespace sgs::render
