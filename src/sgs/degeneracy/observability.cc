// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/degeneracy/observability.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sgs/core/error.h"
#include "sgs/degeneracy/spectrum.h"

namespace sgs::degeneracy {

Matrix6d SurfaceInformation::camera_from_scaled() const {
  Matrix6d A = Matrix6d::Identity();
  A.topLeftCorner<3, 3>() /= scale_m();
  A.bottomLeftCorner<3, 3>() = hat(centroid_m) / scale_m();
  return A;
}

Matrix6d SurfaceInformation::scaled_from_camera() const {
  Matrix6d A = Matrix6d::Identity();
  A.topLeftCorner<3, 3>() *= scale_m();
  A.bottomLeftCorner<3, 3>() = -hat(centroid_m);
  return A;
}

SurfaceInformation accumulate(const SurfaceSamples& s, int noise_stride) {
  const std::size_t n = s.points.size();
  SGS_CHECK(s.normals.size() == n && s.weights.size() == n && s.normal_noise.size() == n,
            "surface arrays differ in length");
  SGS_CHECK(noise_stride >= 1, "noise stride must be positive");
  SurfaceInformation out;
  out.count = static_cast<int>(n);
  if (n == 0) return out;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const auto& p : s.points) sum += p.cast<double>();
  out.centroid_m = sum / static_cast<double>(n);
  double squares = 0;
  for (const auto& p : s.points) squares += (p.cast<double>() - out.centroid_m).squaredNorm();
  out.radius_m = std::sqrt(squares / static_cast<double>(n));
  if (!(out.radius_m > 0)) return out;

  double weight_all = 0, weight_noise = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector3d p = (s.points[i].cast<double>() - out.centroid_m) / out.radius_m;
    const Eigen::Vector3d normal = s.normals[i].cast<double>();
    const double w = static_cast<double>(s.weights[i]);
    Vector6d J;
    J << normal.cross(p), -normal;
    out.H.noalias() += (w * J) * J.transpose();
    weight_all += w;
    if (i % static_cast<std::size_t>(noise_stride) != 0) continue;
    weight_noise += w;
    const double sigma = static_cast<double>(s.normal_noise[i]);
    const Eigen::Matrix3d M =
        w * sigma * sigma * (Eigen::Matrix3d::Identity() - normal * normal.transpose());
    const Eigen::Matrix3d PM = hat(p) * M;
    out.N.topLeftCorner<3, 3>() += PM * hat(p).transpose();
    out.N.topRightCorner<3, 3>() += PM;
    out.N.bottomRightCorner<3, 3>() += M;
  }
  out.N.bottomLeftCorner<3, 3>() = out.N.topRightCorner<3, 3>().transpose();
  if (weight_noise > 0) out.N *= weight_all / weight_noise;
  return out;
}

Observability observe(const SurfaceInformation& information, const DegeneracyConfig& config,
                      HysteresisState& state, const SE3& T_previous_current) {
  Observability out;
  if (information.count < std::max(1, config.min_points) || !(information.radius_m > 0)) {
    state = {Matrix6d::Identity(), Matrix6d::Identity()};
    return out;
  }
  out.axes = spectrum(information.H).axes;
  const Matrix6d A = information.camera_from_scaled();
  out.camera_axes = (A * out.axes).colwise().normalized();
  const Matrix6d A_inverse = information.scaled_from_camera();
  const Matrix6d previous_from_current =
      state.scaled_from_camera * T_previous_current.adjoint() * A;
  Matrix6d unseen = Matrix6d::Zero(), weak = Matrix6d::Zero();
  out.mask = 0;
  for (int k = 0; k < 6; ++k) {
    const Vector6d v = out.axes.col(k);
    const double signal = std::max(0.0, v.dot(information.H * v));
    const double noise = v.dot(information.N * v);
    // Neither signal nor noise (an exact plane without noise) is not seen either.
    const double floor = 1e-12 * information.H.trace();
    out.snr(k) = noise > floor    ? signal / noise
                 : signal > floor ? std::numeric_limits<double>::infinity()
                                  : 0.0;
    const Vector6d before = (previous_from_current * v).normalized();
    const double membership = std::clamp(before.dot(state.weak * before), 0.0, 1.0);
    const double threshold = config.snr_threshold * std::pow(config.hysteresis, membership);
    out.weights(k) =
        out.snr(k) > 0 ? std::clamp(std::log2(2 * threshold / out.snr(k)), 0.0, 1.0) : 1.0;
    unseen += out.weights(k) * v * v.transpose();
    if (out.weights(k) > 0.5) {
      out.mask |= 1U << k;
      weak += v * v.transpose();
    }
  }
  out.P = A * unseen * A_inverse;
  out.K = Matrix6d::Identity() - out.P;
  state = {weak, A_inverse};
  return out;
}

}  // namespace sgs::degeneracy
