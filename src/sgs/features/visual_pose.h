// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "sgs/features/orb.h"

namespace sgs::features {

/// What became of a visual pose estimate.
enum class Verdict { kOk, kTooFewMatches, kTooFewInliers, kImplausibleMotion };
constexpr auto enum_names(Verdict) {
  using enum Verdict;
  return std::to_array<EnumName<Verdict>>({{kOk, "ok"},
                                           {kTooFewMatches, "too few matches"},
                                           {kTooFewInliers, "too few inliers"},
                                           {kImplausibleMotion, "implausible motion"}});
}

/// Pose from features. Anything but kOk must not be used as a measurement.
struct VisualPose {
  SE3 T_world_camera;
  Matrix6d information = Matrix6d::Zero();  ///< metric, on twists of the camera
  int matches = 0, inliers = 0;
  Verdict verdict = Verdict::kTooFewMatches;
  int keyframe = -1;  ///< of a relocalisation
};

/// A known 3D point seen at a pixel.
struct Observation {
  Eigen::Vector3d p_world;
  Eigen::Vector2d uv;
  double sigma_px = 1;
  double depth_m = 0;        ///< measured in the current frame; 0 = none
  double depth_sigma_m = 0;  ///< of the difference between measured and predicted depth
};

/// Normal equations of the reprojection (and depth) residuals uv - pi(T^-1 p), Huber weights;
/// `inliers` counts pixels within `huber` standard deviations (both coordinates).
struct ReprojectionLinearization {
  Matrix6d H = Matrix6d::Zero();
  Vector6d b = Vector6d::Zero();
  double cost = 0;
  int inliers = 0;
};
ReprojectionLinearization linearize(const std::vector<Observation>& observations,
                                    const PinholeCamera& camera, const SE3& T_world_camera,
                                    double huber);

/// Pose-only Gauss-Newton from `T_start`; information and inliers at the result, kOk with at least
/// min_inliers.
VisualPose refine(const std::vector<Observation>& observations, const PinholeCamera& camera,
                  const SE3& T_start, const VisualPoseConfig& config);

/// PnP with RANSAC (EPnP on samples; OpenCV seeds its generator anew in each call, so equal input
/// gives equal output). Returns the pose and the indices of inliers; empty when none was found.
struct PnpResult {
  SE3 T_world_camera;
  std::vector<int> inliers;
};
PnpResult pnp_ransac(const std::vector<Observation>& observations, const PinholeCamera& camera,
                     const VisualPoseConfig& config);

/// The paper's prior (section 5 of the method): matches to the previous frame, PnP, reprojection
/// Hessian over the inliers with sigma 1 px. Implausible motion is rejected, and then (as without
/// enough matches) the pose is the previous one.
VisualPose frame_to_frame_prior(const OrbFrame& previous, const SE3& T_world_previous,
                                const OrbFrame& current, const VisualPoseConfig& config);

}  // namespace sgs::features
