// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "sgs/camera/rgbd_frame.h"
#include "sgs/map/gaussian.h"
#include "sgs/render/rasterizer.h"
#include "sgs/tracker/tracker_config.h"

namespace sgs::tracker {

/// Looks for the pose from which the map looks most like a frame, at half resolution, down the
/// gradient of what colour and depth of the rendering differ by. Only pixels count that the map
/// explains when it is looked at from the start, and where depth was measured. Of all poses on the
/// way the best one counts.
class PoseDescent {
 public:
  /// `rasterizer` must outlive it.
  PoseDescent(const RenderingConfig& config, render::Rasterizer& rasterizer)
      : config_(config), rasterizer_(&rasterizer) {}

  /// Camera to world, from a start not far away; the start itself where the map explains nothing of
  /// the frame. `config.method` kAdam: Adam on the camera's twist (as Keetha et al., SplaTAM,
  /// CVPR 2024); otherwise Newton's steps with the curvature that the frame itself
  /// promises (render::pose_information).
  SE3 descend(std::span<const map::Gaussian> gaussians, const RgbdFrame& frame,
              const SE3& T_world_start);

 private:
  class Target;
  SE3 newton(Target& target, const SE3& T_world_start) const;
  SE3 adam(Target& target, const SE3& T_world_start) const;

  RenderingConfig config_;
  render::Rasterizer* rasterizer_;
  render::Rendering rendering_;
  render::Gradients gradients_;
};

}  // namespace sgs::tracker
