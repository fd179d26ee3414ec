// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>

#include "sgs/degeneracy/degeneracy_config.h"
#include "sgs/geometry/se3.h"

namespace sgs::degeneracy {

/// Oriented surface points of one frame in camera coordinates; four arrays of equal length.
struct SurfaceSamples {
  std::span<const Eigen::Vector3f> points;   ///< metres
  std::span<const Eigen::Vector3f> normals;  ///< unit; the sign does not matter
  std::span<const float> weights;            ///< 1 / variance along the normal, 1/m^2
  std::span<const float> normal_noise;       ///< standard deviation of the normal, rad
};

/// Point-to-plane information of a frame about its own surface, and the part of it that noise in
/// the normals alone would produce. Twists are taken about the centroid with rotations divided by
/// the RMS radius, so that all six axes are in metres and comparable.
struct SurfaceInformation {
  Matrix6d H = Matrix6d::Zero();  ///< sum w J J^T, J = [n x (a-c)/rho; -n]
  Matrix6d N = Matrix6d::Zero();  ///< sum w s^2 B (I - n n^T) B^T, B = [-[(a-c)/rho]x; -I]
  Eigen::Vector3d centroid_m = Eigen::Vector3d::Zero();
  double radius_m = 0;  ///< RMS distance from the centroid
  int count = 0;
  /// What rotations are divided by: the radius; 1 m where there is no surface.
  double scale_m() const { return radius_m > 0 ? radius_m : 1.0; }
  /// Camera twist of a scaled and centred one.
  Matrix6d camera_from_scaled() const;
  Matrix6d scaled_from_camera() const;
};

/// Sums in array order (bitwise repeatable); every `noise_stride`-th point enters N, scaled up.
SurfaceInformation accumulate(const SurfaceSamples& samples, int noise_stride);

/// What geometry sees: axis k is unseen to the degree w_k.
struct Observability {
  Matrix6d axes = Matrix6d::Identity();         ///< columns v_k: scaled and centred twists
  Matrix6d camera_axes = Matrix6d::Identity();  ///< the same as unit camera twists
  Vector6d snr = Vector6d::Zero();              ///< v'Hv / v'Nv; infinite where N is 0 but H is not
  Vector6d weights = Vector6d::Ones();          ///< clamp(ln(2 s0 / SNR) / ln 2, 0, 1)
  unsigned mask = 0x3f;                         ///< bit k where w_k > 0.5
  Matrix6d P = Matrix6d::Identity();            ///< camera twists -> their unseen part
  Matrix6d K = Matrix6d::Zero();                ///< I - P
};

/// Which subspace was weak in the last frame. Single axes cannot be followed: inside a weak
/// subspace eigenvectors turn freely and swap. What is carried is therefore the projector onto the
/// subspace, and an axis is "the same" to the degree it lies in it.
struct HysteresisState {
  Matrix6d weak = Matrix6d::Zero();  ///< projector on scaled twists of the last frame
  Matrix6d scaled_from_camera = Matrix6d::Identity();  ///< of the last frame
};

/// Axes, signal-to-noise ratios and weights. The threshold of an axis is s0 h^m, m = its share in
/// the subspace that was weak in the last frame (hysteresis h): an axis turns weak at s0 and strong
/// again at h s0, so a ratio that hovers at the threshold does not flicker. `state` is read and
/// replaced; `T_previous_current` turns the current camera's twists into the previous one's
/// (identity is good enough at frame rate).
Observability observe(const SurfaceInformation& information, const DegeneracyConfig& config,
                      HysteresisState& state, const SE3& T_previous_current = {});

}  // namespace sgs::degeneracy
