// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sgs/camera/pinhole.h"
#include "sgs/geometry/se3.h"
#include "sgs/map/gaussian.h"
#include "sgs/render/rasterizer.h"

namespace sgs::benchmarks {

/// A furnished room of 6 x 4.5 x 2.8 m covered evenly with Gaussians whose tangential sigma is
/// `sigma` times their spacing; the camera in one corner sees about 40 % of them.
std::vector<map::Gaussian> make_room(int gaussians, double sigma);
/// As many Gaussians, all of them on the surfaces that the camera sees (the dense scene).
std::vector<map::Gaussian> make_view_filling(int gaussians, double sigma);

/// 525 px focal length at 640 x 480, scaled with the width.
PinholeCamera room_camera(int width);
SE3 room_pose();

/// A training view: a rendering of the scene disturbed by up to 10 %.
render::TrainingImage disturbed_view(render::Rasterizer& rasterizer,
                                     const std::vector<map::Gaussian>& gaussians,
                                     const PinholeCamera& camera, const SE3& pose);

}  // namespace sgs::benchmarks
