// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/registration/cell_match.h"
#include "sgs/registration/correspondence_search.h"

namespace sgs::registration {

/// Projective search: an index image of the map as seen from the predicted pose. Each cell of a few
/// pixels keeps the nearest target whose normal faces the camera; a source point is projected into
/// the image and takes the nearest of the 3x3 cells around it that agrees in normal. The reference
/// frame is the predicted camera.
class ProjectiveSearch : public CorrespondenceSearch {
 public:
  ProjectiveSearch(const SearchConfig& config, const PinholeCamera& camera);

  void prepare(const TargetCloud& cloud, const SE3& T_map_predicted) override;
  void match(const SourceCloud& cloud, const SE3& T_reference_camera,
             std::vector<int>& matches) const override;
  bool occupied(const Eigen::Vector3f& point, const Eigen::Vector3f& normal, float radius_m,
                float distance_m) const override;
  SE3 T_map_reference() const override { return T_map_reference_; }
  std::span<const TargetPoint> targets() const override { return targets_; }
  std::span<const Eigen::Matrix3f> covariances() const override { return covariances_; }

 private:
  int cell(const Eigen::Vector3f& point) const { return cell_of(camera_, width_, height_, point); }

  void follow(const TargetCloud& cloud);

  SearchConfig config_;
  int width_, height_;  // cells, with a border of one empty cell all around
  CellCamera camera_;
  SE3 T_map_reference_;
  // The cloud's points, structure of arrays: most need nothing else.
  std::vector<float> points_[3], normals_[3];
  std::uint64_t layout_ = 0, moves_ = 0;  // of the cloud they were taken from
  std::vector<int> cells_;                // index into targets_ per cell, or kNoMatch
  std::vector<float> depths_;             // of the winner of each cell
  CellTargets cell_targets_;              // the winners again, by cell
  std::vector<TargetPoint> targets_;      // the winners
  std::vector<Eigen::Matrix3f> covariances_;
};

}  // namespace sgs::registration
