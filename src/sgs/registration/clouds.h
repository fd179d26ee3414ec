// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace sgs::registration {

/// One sampled surface point of a frame, camera coordinates.
struct SourcePoint {
  Eigen::Vector3f point;       ///< metres
  Eigen::Vector3f normal;      ///< unit, towards the camera
  float variance_m2 = 0;       ///< of the point along its normal
  float normal_sigma = 0;      ///< standard deviation of the normal's direction in radians
  std::uint16_t u = 0, v = 0;  ///< pixel it was sampled at
};

/// The points of one frame that take part in its registration, in raster order.
struct SourceCloud {
  std::vector<SourcePoint> points;
  /// Normalised ellipses in camera coordinates, same order; empty unless G-ICP asks for them.
  std::vector<Eigen::Matrix3f> covariances;
};

/// One point of the map that frames are registered to; never across two cache lines.
struct alignas(32) TargetPoint {
  Eigen::Vector3f point;
  Eigen::Vector3f normal;  ///< unit, towards the camera that saw it
  float variance_m2 = 0;   ///< along the normal; 0 marks a point that has been removed
  float opacity = 1;       ///< of the Gaussian it stands for, 0..1; 1 for other points
  bool alive() const { return variance_m2 > 0; }
};

/// Targets in local coordinates (those of the tracker's first camera). Indices are stable: points
/// are appended, moved a little or marked as removed, and `layout` changes whenever that is not so
/// and an index must start afresh.
struct TargetCloud {
  std::vector<TargetPoint> points;
  std::vector<Eigen::Matrix3f> covariances;  ///< normalised ellipses; empty or one per point
  std::uint64_t layout = 0;
  /// Changes whenever points that were there before have moved or come back.
  std::uint64_t moves = 0;
  /// Those that were marked as removed while `layout` was what it is, in that order; none of a
  /// cloud that counts these as moves.
  std::vector<std::int32_t> removed;
};

/// Ellipse of a plane with unit normal `n` as G-ICP normalises it: 1 along the surface, `floor`
/// along the normal (Segal, Haehnel, Thrun: Generalized-ICP, RSS 2009).
inline Eigen::Matrix3f plane_ellipse(const Eigen::Vector3f& n, float floor) {
  return Eigen::Matrix3f::Identity() - (1.0f - floor) * n * n.transpose();
}

}  // namespace sgs::registration
