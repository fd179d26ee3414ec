// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/registration/cell_match.h"
#include "sgs/registration/correspondence_search.h"
#include "sgs/registration/target_shortlist.h"

namespace sgs::registration {

/// Projective search: an index image of the map as seen from the predicted pose. Each cell of a few
/// pixels keeps the nearest target whose normal faces the camera; a source point is projected into
/// the image and takes the nearest of the 3x3 cells around it that agrees in normal. The reference
/// frame is the predicted camera.
class ProjectiveSearch : public CorrespondenceSearch {
 public:
  ProjectiveSearch(const SearchConfig& config, const PinholeCamera& camera);

  void prepare(const TargetCloud& cloud, const SE3& T_local_predicted) override;
  void match(const SourceCloud& cloud, const SE3& T_reference_camera,
             std::vector<int>& matches) const override;
  bool occupied(const Eigen::Vector3f& point, const Eigen::Vector3f& normal, float radius_m,
                float distance_m) const override;
  bool stands_before(const Eigen::Vector3f& point, float margin_m) const override;
  SE3 T_local_reference() const override { return T_local_reference_; }
  std::span<const TargetPoint> targets() const override { return targets_; }
  std::span<const Eigen::Matrix3f> covariances() const override { return covariances_; }

 private:
  int cell(const Eigen::Vector3f& point) const { return cell_of(camera_, width_, height_, point); }

  void draw(const Eigen::Matrix3f& R, const Eigen::Vector3f& t);
  void collect(const TargetCloud& cloud, const Eigen::Matrix3f& R, const Eigen::Vector3f& t);

  SearchConfig config_;
  int width_, height_;  // cells, with a border of one empty cell all around
  CellCamera camera_;
  SE3 T_local_reference_;
  TargetShortlist shortlist_;
  std::vector<int> cells_;            // index into targets_ per cell, or kNoMatch
  std::vector<float> depths_;         // of the winner of each cell
  CellTargets cell_targets_;          // the winners again, by cell
  std::vector<TargetPoint> targets_;  // the winners
  std::vector<Eigen::Matrix3f> covariances_;
};

}  // namespace sgs::registration
