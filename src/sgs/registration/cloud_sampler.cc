// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/registration/cloud_sampler.h"

#include "sgs/registration/neighbour_sampler.h"
#include "sgs/registration/plane_fit_sampler.h"

namespace sgs::registration {

std::unique_ptr<CloudSampler> make_sampler(const SamplingConfig& config,
                                           const PinholeCamera& camera, bool with_ellipses) {
  if (config.method == SamplingMethod::kNeighbours) {
    return std::make_unique<NeighbourSampler>(config, camera);
  }
  return std::make_unique<PlaneFitSampler>(config, camera, with_ellipses);
}

}  // namespace sgs::registration
