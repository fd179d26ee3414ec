// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/registration/correspondence_search.h"
#include "sgs/registration/nearest_forest.h"

namespace sgs::registration {

/// Nearest-mean search (the paper's Eq. 1) in the whole map. The reference frame is the map's.
class NearestSearch : public CorrespondenceSearch {
 public:
  explicit NearestSearch(const SearchConfig& config) : config_(config) {}

  void prepare(const TargetCloud& cloud, const SE3& T_local_predicted) override;
  void match(const SourceCloud& cloud, const SE3& T_reference_camera,
             std::vector<int>& matches) const override;
  bool occupied(const Eigen::Vector3f& point, const Eigen::Vector3f& normal, float radius_m,
                float distance_m) const override;
  SE3 T_local_reference() const override { return {}; }
  std::span<const TargetPoint> targets() const override { return cloud_->points; }
  std::span<const Eigen::Matrix3f> covariances() const override { return cloud_->covariances; }

 private:
  SearchConfig config_;
  const TargetCloud* cloud_ = nullptr;
  NearestForest forest_;
};

}  // namespace sgs::registration
