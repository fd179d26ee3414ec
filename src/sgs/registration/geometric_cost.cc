// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/registration/geometric_cost.h"

#include "sgs/registration/gicp_factor.h"
#include "sgs/registration/plane_factor.h"

namespace sgs::registration {
namespace {

constexpr std::size_t kChunk = 256;  // source points summed in float

struct Pose {
  explicit Pose(const SE3& T) : R(T.R.cast<float>()), t(T.t.cast<float>()) {}
  Eigen::Matrix3f R;
  Eigen::Vector3f t;
};

}  // namespace

GeometricCost::GeometricCost(const FactorConfig& config)
    : config_(config), gicp_(config.type == FactorType::kGicp) {}

Linearization GeometricCost::linearize(const SourceCloud& source,
                                       const CorrespondenceSearch& search,
                                       const SE3& T_reference_camera, const CellMask& moving) {
  search.match(source, T_reference_camera, matches_);
  for (std::size_t i = 0; moving.any() && i < matches_.size(); ++i) {
    const SourcePoint& p = source.points[i];
    if (moving.at(p.u, p.v)) matches_[i] = CorrespondenceSearch::kNoMatch;
  }
  return relinearize(source, search, T_reference_camera);
}

Linearization GeometricCost::relinearize(const SourceCloud& source,
                                         const CorrespondenceSearch& search,
                                         const SE3& T_reference_camera) const {
  SGS_CHECK(matches_.size() == source.points.size(), "relinearize() needs a linearize() before it");
  const auto targets = search.targets();
  const auto covariances = search.covariances();
  const bool has_ellipses =
      source.covariances.size() == source.points.size() && covariances.size() == targets.size();
  SGS_CHECK(!gicp_ || has_ellipses, "G-ICP needs ellipses of sources and targets");
  const Pose pose(T_reference_camera);
  const float huber = static_cast<float>(config_.huber),
              reject = static_cast<float>(config_.reject);
  const PlaneFactor<float> plane{{huber}, reject};
  const GicpFactor<float> gicp{{huber}, reject};

  Linearization total;
  ChunkSums<float> sums;
  for (std::size_t begin = 0; begin < matches_.size(); begin += kChunk) {
    const std::size_t end = std::min(begin + kChunk, matches_.size());
    for (std::size_t i = begin; i < end; ++i) {
      if (matches_[i] < 0) continue;
      const auto k = static_cast<std::size_t>(matches_[i]);
      const SourcePoint& a = source.points[i];
      const TargetPoint& b = targets[k];
      if (gicp_) {
        gicp.linearize(a.point, source.covariances[i], b.point, covariances[k], pose.R, pose.t,
                       sums);
      } else {
        plane.linearize(a.point, a.variance_m2, b.point, b.normal, b.variance_m2, pose.R, pose.t,
                        sums);
      }
    }
    sums.flush_into(total);
  }
  return total;
}

double GeometricCost::error(const SourceCloud& source, const CorrespondenceSearch& search,
                            const SE3& T_reference_camera) const {
  SGS_CHECK(matches_.size() == source.points.size(), "error() needs a linearize() before it");
  const auto targets = search.targets();
  const auto covariances = search.covariances();
  const Pose pose(T_reference_camera);
  const float huber = static_cast<float>(config_.huber),
              reject = static_cast<float>(config_.reject);
  const PlaneFactor<float> plane{{huber}, reject};
  const GicpFactor<float> gicp{{huber}, reject};
  double total = 0;
  for (std::size_t begin = 0; begin < matches_.size(); begin += kChunk) {
    const std::size_t end = std::min(begin + kChunk, matches_.size());
    float sum = 0;
    for (std::size_t i = begin; i < end; ++i) {
      if (matches_[i] < 0) continue;
      const auto k = static_cast<std::size_t>(matches_[i]);
      const SourcePoint& a = source.points[i];
      const TargetPoint& b = targets[k];
      sum += gicp_ ? gicp.error(a.point, source.covariances[i], b.point, covariances[k], pose.R,
                                pose.t)
                   : plane.error(a.point, a.variance_m2, b.point, b.normal, b.variance_m2, pose.R,
                                 pose.t);
    }
    total += static_cast<double>(sum);
  }
  return total;
}

double GeometricCost::overlap(const SourceCloud& source, const CorrespondenceSearch& search,
                              const SE3& T_reference_camera, double distance_m) const {
  SGS_CHECK(matches_.size() == source.points.size(), "overlap() needs a linearize() before it");
  if (matches_.empty()) return 0;
  const auto targets = search.targets();
  const Pose pose(T_reference_camera);
  const float limit2 = static_cast<float>(distance_m * distance_m);
  std::size_t explained = 0;
  for (std::size_t i = 0; i < matches_.size(); ++i) {
    if (matches_[i] < 0) continue;
    const Eigen::Vector3f x = pose.R * source.points[i].point + pose.t;
    const TargetPoint& b = targets[static_cast<std::size_t>(matches_[i])];
    explained += (b.point - x).squaredNorm() < limit2 ? 1 : 0;
  }
  return static_cast<double>(explained) / static_cast<double>(matches_.size());
}

}  // namespace sgs::registration
