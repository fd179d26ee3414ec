// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "sgs/camera/pinhole.h"
#include "sgs/core/image.h"
#include "sgs/registration/clouds.h"
#include "sgs/registration/registration_config.h"

namespace sgs::registration {

/// Inverse depth around a pixel: q(u, v) = q + slope . (u - u0, v - v0), 1/m and 1/(m px).
struct InverseDepthPlane {
  float q = 0;  ///< 0 = none
  float slope_u = 0, slope_v = 0;
  float support = 0;  ///< share of the window's samples that lie on the plane
};

/// Turns a depth image into points with normals and noise. Implementations keep scratch memory:
/// not thread-safe, but deterministic.
class CloudSampler {
 public:
  virtual ~CloudSampler() = default;
  /// Replaces the contents of `cloud`. `depth` must have the camera's size.
  virtual void sample(const DepthImage& depth, SourceCloud& cloud) = 0;
  /// The plane fitted around any pixel of the image last sampled; none where there is no
  /// measurement, and always where the method fits no surface.
  virtual InverseDepthPlane inverse_depth_plane(int, int) const { return {}; }
};

/// The sampler that `config.method` names. `with_ellipses` asks for covariances too.
std::unique_ptr<CloudSampler> make_sampler(const SamplingConfig& config,
                                           const PinholeCamera& camera, bool with_ellipses);

}  // namespace sgs::registration
