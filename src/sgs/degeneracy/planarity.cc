// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/degeneracy/planarity.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "sgs/core/error.h"

namespace sgs::degeneracy {
namespace {

struct Moments {
  double weight = 0;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
};

Moments moments(std::span<const Eigen::Vector3f> normals, std::span<const float> weights) {
  SGS_CHECK(normals.size() == weights.size(), "normals and weights differ in length");
  Moments m;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const Eigen::Vector3d n = normals[i].cast<double>();
    const double w = static_cast<double>(weights[i]);
    m.weight += w;
    m.mean += w * n;
    m.second += w * n * n.transpose();
  }
  if (m.weight > 0) {
    m.mean /= m.weight;
    m.second /= m.weight;
  }
  return m;
}

Eigen::Vector3d eigenvalues(const Eigen::Matrix3d& m) {
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(m, Eigen::EigenvaluesOnly).eigenvalues();
}

}  // namespace

Planarity paper_planarity(std::span<const Eigen::Vector3f> normals, std::span<const float> weights,
                          const DegeneracyConfig& config) {
  const Moments m = moments(normals, weights);
  if (!(m.weight > 0)) return {};
  Planarity out;
  out.eigenvalues = eigenvalues(m.second - m.mean * m.mean.transpose());
  const double ratio = out.eigenvalues(2) / (out.eigenvalues(1) + 1e-6);
  const double width = std::max(1e-9, config.planarity_ratio_max - config.planarity_ratio_min);
  out.eta = std::clamp((ratio - config.planarity_ratio_min) / width, 0.0, 1.0);
  return out;
}

Planarity planarity(std::span<const Eigen::Vector3f> normals, std::span<const float> weights) {
  const Moments m = moments(normals, weights);
  if (!(m.weight > 0)) return {};
  Planarity out;
  out.eigenvalues = eigenvalues(m.second);
  if (out.eigenvalues(2) > 0) {
    out.eta = std::clamp((out.eigenvalues(2) - out.eigenvalues(1)) / out.eigenvalues(2), 0.0, 1.0);
  }
  return out;
}

double planarity_gate(double eta, double alpha) { return std::exp(-alpha * (1 - eta)); }

}  // namespace sgs::degeneracy
