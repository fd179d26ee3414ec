// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "sgs/camera/pinhole.h"
#include "sgs/core/image.h"
#include "sgs/registration/clouds.h"
#include "sgs/registration/registration_config.h"

namespace sgs::registration {

/// Turns a depth image into points with normals and noise. Implementations keep scratch memory:
/// not thread-safe, but deterministic.
class CloudSampler {
 public:
  virtual ~CloudSampler() = default;
  /// Replaces the contents of `cloud`. `depth` must have the camera's size.
  virtual void sample(const DepthImage& depth, SourceCloud& cloud) = 0;
  /// Smoothed depth at any pixel of the image last sampled, metres; 0 where there is none, and
  /// always where the method fits no surface.
  virtual float smooth_depth(int, int) const { return 0; }
};

/// The sampler that `config.method` names. `with_ellipses` asks for covariances too.
std::unique_ptr<CloudSampler> make_sampler(const SamplingConfig& config,
                                           const PinholeCamera& camera, bool with_ellipses);

}  // namespace sgs::registration
