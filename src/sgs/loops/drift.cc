// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/loops/drift.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace sgs::loops {
namespace {

/// Twists with turns measured in metres at a depth, from twists in radians.
Vector6d scale_of(double depth_m) {
  Vector6d scale = Vector6d::Ones();
  scale.head<3>().setConstant(depth_m);
  return scale;
}

Matrix6d symmetric(const Matrix6d& A) { return 0.5 * (A + A.transpose()); }

}  // namespace

Matrix6d edge_information(const Matrix6d& normal_equations, double mean_depth_m,
                          double min_information, const DriftConfig& config) {
  const Vector6d scale = scale_of(mean_depth_m), inverse = scale.cwiseInverse();
  const Matrix6d scaled = inverse.asDiagonal() * normal_equations * inverse.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(symmetric(scaled));
  Vector6d values = Vector6d::Zero();
  for (int k = 0; k < 6; ++k) {
    const double seen = eigen.eigenvalues()[k];
    if (!(seen >= min_information)) continue;
    values[k] = 1 / (1 / (config.information_scale * seen) + config.floor_m * config.floor_m);
  }
  const Matrix6d& V = eigen.eigenvectors();
  return symmetric(scale.asDiagonal() * (V * values.asDiagonal() * V.transpose()) *
                   scale.asDiagonal());
}

Matrix6d motion_covariance(const Matrix6d& normal_equations, double mean_depth_m, double path_m,
                           double gap_s, const DriftConfig& config) {
  constexpr double kLeast = 1e-9;  // of the largest eigenvalue: keeps the inverse finite
  const Vector6d scale = scale_of(mean_depth_m), inverse = scale.cwiseInverse();
  const Matrix6d scaled = inverse.asDiagonal() * normal_equations * inverse.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(symmetric(scaled));
  const Vector6d seen =
      eigen.eigenvalues().cwiseMax(std::max(1.0, kLeast * eigen.eigenvalues()[5]));
  const Matrix6d& V = eigen.eigenvectors();
  const Vector6d variances = (config.information_scale * seen).cwiseInverse();
  const Matrix6d alignment =
      inverse.asDiagonal() * (V * variances.asDiagonal() * V.transpose()) * inverse.asDiagonal();
  const auto square = [](double x) { return x * x; };
  const double floor = square(config.floor_m);
  const double turn = square(config.rotation_deg_per_m * std::numbers::pi / 180) * path_m +
                      square(config.lost_turn_rad_per_s * gap_s) + floor / square(mean_depth_m);
  const double shift =
      square(config.translation_per_m) * path_m + square(config.lost_speed_m_per_s * gap_s) + floor;
  Vector6d drift;
  drift << Eigen::Vector3d::Constant(turn), Eigen::Vector3d::Constant(shift);
  return symmetric(alignment) + Matrix6d(drift.asDiagonal());
}

double deviation_chi2(const graph::Edge& edge, const graph::UncertainPose& expected) {
  const Matrix6d& L = edge.information;
  const Vector6d e = (edge.T_from_to.inverse() * expected.T).log();
  // e^T (S + L^-1)^-1 e, with L of any rank: L - L (S^-1 + L)^-1 L.
  const Matrix6d inner = (expected.covariance.inverse() + L).inverse();
  const Matrix6d weight = L - L * inner * L;
  return e.dot(weight * e);
}

}  // namespace sgs::loops
