// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace sgs::registration {

/// The pyramid that a pinhole camera looks into: tells as a whole what lies outside of it.
class ViewPyramid {
 public:
  /// `focal` and `centre` in pixels (or cells), the picture from `low` to `high`.
  ViewPyramid(const Eigen::Vector2f& focal, const Eigen::Vector2f& centre,
              const Eigen::Vector2f& low, const Eigen::Vector2f& high) {
    const Eigen::Vector2f to_low = centre - low, to_high = high - centre;
    sides_.row(0) << focal.x(), 0, to_low.x();
    sides_.row(1) << -focal.x(), 0, to_high.x();
    sides_.row(2) << 0, focal.y(), to_low.y();
    sides_.row(3) << 0, -focal.y(), to_high.y();
    sides_.rowwise().normalize();
  }

  /// False where no point of a sphere (camera coordinates, metres) projects into the picture.
  /// Points at its border may count as inside, never as outside.
  bool may_meet(const Eigen::Vector3f& centre, float radius) const {
    const float reach = radius + kSlack * (1 + centre.norm());
    // Written so that NaN may.
    return !(centre.z() < -reach) && !((sides_ * centre).minCoeff() < -reach);
  }

 private:
  static constexpr float kSlack = 1e-4f;  // of rounding, relative
  Eigen::Matrix<float, 4, 3> sides_;      // normals of unit length, inwards
};

}  // namespace sgs::registration
