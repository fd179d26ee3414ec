// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/registration/cloud_sampler.h"

namespace sgs::registration {

/// Samples a depth image on a regular grid and estimates point, normal and metric noise from a
/// plane fit in inverse depth.
///
/// On a plane n.p = d inverse depth is affine in the pixel, q = alpha u + beta v + gamma, so the
/// fit is linear and its residuals have the sensor's (nearly constant) disparity noise; a fit in
/// depth would turn quantised disparity into terraces. Two rounds: a gate that admits the steepest
/// slopes, then three standard deviations about the first plane. Then
///     z = 1 / gamma,   N = (alpha f_x, beta f_y, gamma - alpha f_x x - beta f_y y),   n = -N /
///     |N|, sigma_n^2 = (sigma_z |n.(x, y, 1)|)^2 / m + floor^2, inflated where the fit is bad,
///     sigma_normal = f_x sigma_q / (|N| sqrt(samples r^2 / 3)).
/// Points across depth edges, at flat incidence and without support are dropped.
///
/// Not thread-safe (keeps a scratch image); deterministic.
class PlaneFitSampler : public CloudSampler {
 public:
  /// `with_ellipses` adds the planar ellipse of each normal for G-ICP.
  PlaneFitSampler(const SamplingConfig& config, const PinholeCamera& camera,
                  bool with_ellipses = false);
  void sample(const DepthImage& depth, SourceCloud& cloud) override;
  InverseDepthPlane inverse_depth_plane(int u, int v) const override;
  /// Sets the image that inverse_depth_plane() looks at, without sampling it.
  void set_depth(const DepthImage& depth) { fill_inverse_depth(depth); }

 private:
  struct Fit;
  bool fit_plane(int column, int row, float sigma_q, Fit& fit) const;
  void fill_inverse_depth(const DepthImage& depth);

  SamplingConfig config_;
  PinholeCamera camera_;
  bool with_ellipses_;
  int half_ = 3;                // samples on either side of the centre, at most 3
  Image<float> inverse_depth_;  // every second pixel, padded with zeros on the left and right
};

}  // namespace sgs::registration
