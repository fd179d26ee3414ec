// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>

#include "sgs/degeneracy/degeneracy_config.h"

namespace sgs::degeneracy {

/// How planar the matched Gaussians are.
struct Planarity {
  double eta = 0;                                         ///< 0 .. 1
  Eigen::Vector3d eigenvalues = Eigen::Vector3d::Zero();  ///< rising
};

/// The paper's score: weighted covariance C of the normals about their mean, r = l3 / (l2 + 1e-6),
/// eta = clamp((r - r_min) / (r_max - r_min), 0, 1). Trap: meaningful only while the signs of the
/// normals are random (the axis of an ellipsoid has none) so that the mean vanishes; oriented
/// normals turn the score upside down (plane ~ 0, fold 1). Reported, and used by the paper preset.
Planarity paper_planarity(std::span<const Eigen::Vector3f> normals, std::span<const float> weights,
                          const DegeneracyConfig& config);

/// Sign-free score: second moment M = sum w n n^T / sum w, eta = (m3 - m2) / m3. One plane 1, three
/// orthogonal planes 0; flipping any normal changes nothing.
Planarity planarity(std::span<const Eigen::Vector3f> normals, std::span<const float> weights);

/// exp(-alpha (1 - eta)) (paper).
double planarity_gate(double eta, double alpha);

}  // namespace sgs::degeneracy
