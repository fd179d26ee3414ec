// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/registration/projective_search.h"

#include <hwy/cache_control.h>

#include <algorithm>
#include <limits>

namespace sgs::registration {
namespace {
constexpr float kNearPlane_m = 0.05f;
}

ProjectiveSearch::ProjectiveSearch(const SearchConfig& config, const PinholeCamera& camera)
    : config_(config),
      width_((camera.width + config.cell_px - 1) / config.cell_px + 2),
      height_((camera.height + config.cell_px - 1) / config.cell_px + 2),
      camera_{static_cast<float>(camera.fx / config.cell_px),
              static_cast<float>(camera.fy / config.cell_px),
              static_cast<float>((camera.cx + 0.5) / config.cell_px + 1),
              static_cast<float>((camera.cy + 0.5) / config.cell_px + 1), kNearPlane_m},
      shortlist_(camera_, width_, height_),
      cell_targets_(width_, height_) {
  SGS_CHECK(camera.valid(), "the search needs a usable camera");
}

void ProjectiveSearch::prepare(const TargetCloud& cloud, const SE3& T_local_predicted) {
  T_local_reference_ = T_local_predicted;
  const SE3 inverse = T_local_predicted.inverse();
  const Eigen::Matrix3f R = inverse.R.cast<float>();
  const Eigen::Vector3f t = inverse.t.cast<float>();
  shortlist_.update(cloud, T_local_predicted);
  draw(R, t);
  collect(cloud, R, t);
}

/// Finds the nearest target of each cell.
void ProjectiveSearch::draw(const Eigen::Matrix3f& R, const Eigen::Vector3f& t) {
  const auto cell_count = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  cells_.assign(cell_count, kNoMatch);
  depths_.assign(cell_count, std::numeric_limits<float>::infinity());
  const std::vector<int>& indices = shortlist_.indices();
  constexpr std::size_t kBatch = 1024;
  int where[kBatch];
  float depth[kBatch];
  for (std::size_t begin = 0; begin < indices.size(); begin += kBatch) {
    const std::size_t count = std::min(kBatch, indices.size() - begin);
    project_to_cells(shortlist_.targets().part(begin, count), camera_, width_, height_, R, t, where,
                     depth);
    for (std::size_t k = 0; k < count; ++k) {
      if (where[k] < 0) continue;
      const auto c = static_cast<std::size_t>(where[k]);
      if (!(depth[k] < depths_[c])) continue;
      depths_[c] = depth[k];
      cells_[c] = indices[begin + k];
    }
  }
}

/// Makes targets of the nearest ones.
void ProjectiveSearch::collect(const TargetCloud& cloud, const Eigen::Matrix3f& R,
                               const Eigen::Vector3f& t) {
  targets_.clear();
  covariances_.clear();
  cell_targets_.clear();
  constexpr std::size_t kAhead = 16;  // the winners lie anywhere in memory: ask for them early
  for (std::size_t c = 0; c < cells_.size(); ++c) {
    if (c + kAhead < cells_.size() && cells_[c + kAhead] != kNoMatch) {
      hwy::Prefetch(&cloud.points[static_cast<std::size_t>(cells_[c + kAhead])]);
    }
    if (cells_[c] == kNoMatch) continue;
    const auto i = static_cast<std::size_t>(cells_[c]);
    const TargetPoint& p = cloud.points[i];
    cells_[c] = static_cast<int>(targets_.size());
    targets_.push_back({R * p.point + t, R * p.normal, p.variance_m2, p.opacity});
    cell_targets_.set(static_cast<int>(c), targets_.back().point, targets_.back().normal);
    if (!cloud.covariances.empty()) {
      covariances_.push_back(R * cloud.covariances[i] * R.transpose());
    }
  }
}

void ProjectiveSearch::match(const SourceCloud& cloud, const SE3& T_reference_camera,
                             std::vector<int>& matches) const {
  matches.resize(cloud.points.size());
  const CellGates gates{static_cast<float>(config_.max_distance_m * config_.max_distance_m),
                        static_cast<float>(config_.min_normal_cosine)};
  match_cells(cell_targets_, camera_, gates, T_reference_camera.R.cast<float>(),
              T_reference_camera.t.cast<float>(), cloud.points, matches);
  for (int& match : matches) {
    match = match < 0 ? kNoMatch : cells_[static_cast<std::size_t>(match)];
  }
}

bool ProjectiveSearch::occupied(const Eigen::Vector3f& point, const Eigen::Vector3f& normal,
                                float radius_m, float distance_m) const {
  constexpr float kSameSurfaceCosine = 0.7f;
  const int centre = cell(point);
  if (centre < 0) return false;
  for (int row = centre - width_; row <= centre + width_; row += width_) {
    for (int cell = row - 1; cell <= row + 1; ++cell) {
      const int k = cells_[static_cast<std::size_t>(cell)];
      if (k < 0) continue;
      const TargetPoint& target = targets_[static_cast<std::size_t>(k)];
      const Eigen::Vector3f d = target.point - point;
      const float off = target.normal.dot(d);
      if (std::abs(off) < distance_m &&
          (d - off * target.normal).squaredNorm() < radius_m * radius_m &&
          target.normal.dot(normal) > kSameSurfaceCosine) {
        return true;
      }
    }
  }
  return false;
}

bool ProjectiveSearch::stands_before(const Eigen::Vector3f& point, float margin_m) const {
  constexpr int kEnoughCells = 3;
  const int centre = cell(point);
  if (centre < 0) return false;
  int known = 0;
  for (int row = centre - width_; row <= centre + width_; row += width_) {
    for (int cell = row - 1; cell <= row + 1; ++cell) {
      if (cells_[static_cast<std::size_t>(cell)] < 0) continue;
      if (depths_[static_cast<std::size_t>(cell)] < point.z() + margin_m) return false;
      ++known;
    }
  }
  return known >= kEnoughCells;
}

}  // namespace sgs::registration
