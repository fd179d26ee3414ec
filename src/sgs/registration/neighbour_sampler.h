// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/registration/cloud_sampler.h"

namespace sgs::registration {

/// The paper's sampling: every n-th pixel as measured, with an ellipse from its 10 nearest sampled
/// points (itself included), eigenvalues divided by the middle one and bounded below
/// (Ha, Yeon, Yu: RGBD GS-ICP SLAM, ECCV 2024). The normal is the ellipse's shortest axis.
///
/// Neighbours come from the 5x5 samples around a point instead of a tree over the whole cloud:
/// the same ones on surfaces that are not steep or torn. Not thread-safe; deterministic.
class NeighbourSampler : public CloudSampler {
 public:
  NeighbourSampler(const SamplingConfig& config, const PinholeCamera& camera);
  void sample(const DepthImage& depth, SourceCloud& cloud) override;

 private:
  bool covariance_at(int column, int row, Eigen::Matrix3f& covariance) const;

  SamplingConfig config_;
  PinholeCamera camera_;
  Image<Eigen::Vector3f> grid_;  // z = 0: no sample
};

}  // namespace sgs::registration
