// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/registration/nearest_search.h"

#include "sgs/registration/projective_search.h"

namespace sgs::registration {

void NearestSearch::prepare(const TargetCloud& cloud, const SE3&) {
  cloud_ = &cloud;
  forest_.update(cloud);
}

void NearestSearch::match(const SourceCloud& cloud, const SE3& T_reference_camera,
                          std::vector<int>& matches) const {
  matches.assign(cloud.points.size(), kNoMatch);
  const Eigen::Matrix3f R = T_reference_camera.R.cast<float>();
  const Eigen::Vector3f t = T_reference_camera.t.cast<float>();
  const float gate = static_cast<float>(config_.max_distance_m);
  const float min_cosine = static_cast<float>(config_.min_normal_cosine);
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const int k = forest_.nearest(R * cloud.points[i].point + t, gate);
    if (k < 0) continue;
    if (min_cosine > -1 && cloud_->points[static_cast<std::size_t>(k)].normal.dot(
                               R * cloud.points[i].normal) <= min_cosine) {
      continue;
    }
    matches[i] = k;
  }
}

bool NearestSearch::occupied(const Eigen::Vector3f& point, const Eigen::Vector3f&, float,
                             float distance_m) const {
  return forest_.nearest(point, distance_m) >= 0;
}

std::unique_ptr<CorrespondenceSearch> make_search(const SearchConfig& config,
                                                  const PinholeCamera& camera) {
  if (config.method == SearchMethod::kNearest) return std::make_unique<NearestSearch>(config);
  return std::make_unique<ProjectiveSearch>(config, camera);
}

}  // namespace sgs::registration
