// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/camera/pinhole.h"
#include "sgs/geometry/se3.h"

namespace sgs::render {

/// Which Gaussians are drawn at all, by the place of their means.
inline constexpr float kNearest_m = 0.1f;
inline constexpr float kFarthest_m = 1e5f;
/// Beyond the limits u_min .. v_max of View, in tangents of the view angle.
inline constexpr float kOutsideMargin = 0.3f;

/// Camera and pose in the form the formulas use; R, t map world to camera.
template <class S>
struct View {
  S fx, fy, cx, cy, width, height;
  S R[9], t[3];
  /// The Jacobian of the projection is taken at tangents clamped to this range: 15 % of the image
  /// beyond each border, so that Gaussians far outside do not explode.
  S u_min, u_max, v_min, v_max;
};

template <class S>
View<S> make_view(const PinholeCamera& camera, const SE3& T_world_camera) {
  View<S> view;
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
