// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace sgs {

/// Standard deviation (metres) of a Kinect-like sensor's depth at `depth_m`
/// (Nguyen, Izadi, Lovell: Modeling Kinect Sensor Noise, 3DIMPVT 2012; axial term).
inline float depth_sigma_m(float depth_m) {
  const float d = depth_m - 0.4f;
  return 0.0012f + 0.0019f * d * d;
}

}  // namespace sgs
