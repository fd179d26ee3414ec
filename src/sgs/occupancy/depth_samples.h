// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sgs/camera/pinhole.h"
#include "sgs/core/image.h"

namespace sgs::occupancy {

/// A measured point of a view.
struct DepthSample {
  Eigen::Vector3d point;  ///< in the camera, metres
  /// Of the surface there, unit, towards the camera; zero where neighbours tell of no surface.
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  double area_m2 = 0;  ///< of the surface that it stands for; 0 without a normal
};

/// Every `stride`-th measured pixel of every `stride`-th row. Depth has the camera's size.
std::vector<DepthSample> sample_depth(const PinholeCamera& camera, const DepthImage& depth,
                                      int stride);

/// The stride at which neighbouring samples at `range_m` lie within a voxel of each other.
int stride_for(const PinholeCamera& camera, double voxel_m, double range_m);

}  // namespace sgs::occupancy
