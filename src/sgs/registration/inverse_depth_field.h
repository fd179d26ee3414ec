// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/camera/pinhole.h"
#include "sgs/core/image.h"
#include "sgs/registration/plane_fit_sampler.h"

namespace sgs::registration {

/// Inverse depth of an image and its slope, from plane fits on a coarse raster: what an alignment
/// that differentiates depth needs, quantised disparities do not have and a tenth of the image's
/// memory holds. Empty where depth has edges. Immutable; thread-safe.
class InverseDepthField {
 public:
  InverseDepthField() = default;
  InverseDepthField(const DepthImage& depth, const PinholeCamera& camera);

  /// Inverse depth at a pixel, on the plane fitted next to it; q = 0 where there is none.
  InverseDepthPlane at(double u, double v) const;

 private:
  Image<InverseDepthPlane> planes_;
};

}  // namespace sgs::registration
