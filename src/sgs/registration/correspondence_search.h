// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "sgs/camera/pinhole.h"
#include "sgs/geometry/se3.h"
#include "sgs/registration/clouds.h"
#include "sgs/registration/registration_config.h"

namespace sgs::registration {

/// Finds a target for every source point. Targets are handed out in a reference frame of the
/// search's choice, so that single precision is enough wherever the map lies.
class CorrespondenceSearch {
 public:
  static constexpr int kNoMatch = -1;

  virtual ~CorrespondenceSearch() = default;
  /// Prepares for a frame expected at `T_local_predicted`. `cloud` must stay unchanged until the
  /// next call; only what changed since the last call is indexed anew where the method can.
  virtual void prepare(const TargetCloud& cloud, const SE3& T_local_predicted) = 0;
  /// Writes, for each source point seen from `T_reference_camera`, an index into targets() or
  /// kNoMatch. `matches` is resized to the cloud.
  virtual void match(const SourceCloud& cloud, const SE3& T_reference_camera,
                     std::vector<int>& matches) const = 0;
  /// Whether a target lies so near to `point` (reference frame) that another one adds nothing:
  /// within `radius_m` along the surface and `distance_m` off it.
  virtual bool occupied(const Eigen::Vector3f& point, const Eigen::Vector3f& normal, float radius_m,
                        float distance_m) const = 0;

  /// Whether `point` (reference frame) stands more than `margin_m` before all surface that is known
  /// around its pixel: in space that was seen to be free. False where too little is known there, or
  /// the method cannot tell.
  virtual bool stands_before(const Eigen::Vector3f& point, float margin_m) const {
    static_cast<void>(point);
    static_cast<void>(margin_m);
    return false;
  }

  virtual SE3 T_local_reference() const = 0;
  /// Targets in the reference frame, and their ellipses (empty if the cloud has none).
  virtual std::span<const TargetPoint> targets() const = 0;
  virtual std::span<const Eigen::Matrix3f> covariances() const = 0;
};

/// The search that `config.method` names.
std::unique_ptr<CorrespondenceSearch> make_search(const SearchConfig& config,
                                                  const PinholeCamera& camera);

}  // namespace sgs::registration
