// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/alignment/targets/snapshot_targets.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace sgs::alignment {
namespace {

bool same_birth(const map::Anchor& a, const map::Anchor& b) {
  return a.keyframe == b.keyframe && a.point == b.point;
}

// Targets that were removed may make up this share of the list before it is compacted.
constexpr double kMaxDeadShare = 0.3;

}  // namespace

SnapshotTargets::SnapshotTargets(const GeometryConfig& config, const SE3& T_local_world,
                                 const TrackablePoints::Spacing& spacing)
    : at_anchors_(config.target.source == TargetSource::kAnchor),
      min_opacity_logit_(
          static_cast<float>(std::log(std::max(config.target.min_opacity, 1e-9) /
                                      std::max(1 - config.target.min_opacity, 1e-9)))),
      covariance_floor_(static_cast<float>(config.points.covariance_floor)),
      scale_sigmas_(static_cast<float>(config.target.scale_sigmas)),
      with_ellipses_(config.factor.type == registration::FactorType::kGicp),
      R_local_world_(T_local_world.R.cast<float>()),
      t_local_world_(T_local_world.t.cast<float>()),
      before_(spacing) {}

const registration::TargetCloud& SnapshotTargets::cloud() const {
  return has_snapshot_ ? cloud_ : before_.cloud();
}

void SnapshotTargets::insert(const registration::SourceCloud& source, const Observer& keyframe,
                             const registration::CorrespondenceSearch* search) {
  if (!has_snapshot_) before_.insert(source, keyframe, search);
}

void SnapshotTargets::append(const map::Anchor& anchor) {
  anchors_.push_back(anchor);
  cloud_.points.emplace_back();
  if (with_ellipses_) cloud_.covariances.emplace_back();
}

// Gives each Gaussian a target index; false when the snapshot's order does not follow the last one.
bool SnapshotTargets::assign_targets(const map::Snapshot& snapshot) {
  const std::size_t known = anchors_.size();
  std::size_t next = 0;
  target_of_.clear();
  for (const map::Anchor& anchor : snapshot.anchors) {
    std::size_t k = next;
    while (k < known && !same_birth(anchors_[k], anchor)) ++k;
    if (k < known) {
      next = k + 1;
      target_of_.push_back(k);
      continue;
    }
    // A new one: from here on only new ones may come, which the scan above must not repeat.
    next = known;
    target_of_.push_back(anchors_.size());
    append(anchor);
  }
  return static_cast<double>(anchors_.size() - snapshot.anchors.size()) <=
         kMaxDeadShare * static_cast<double>(anchors_.size());
}

void SnapshotTargets::set_target(std::size_t target, const map::Gaussian& g,
                                 const map::Anchor& anchor) {
  registration::TargetPoint& p = cloud_.points[target];
  p.variance_m2 = std::max(anchor.sigma_n_m * anchor.sigma_n_m, 1e-10f);
  if (!(g.opacity_logit > min_opacity_logit_)) p.variance_m2 = 0;
  p.opacity = map::opacity(g);
  if (at_anchors_) {
    p.point = R_local_world_ * anchor.point + t_local_world_;
    p.normal = R_local_world_ * anchor.normal;
    if (with_ellipses_) {
      cloud_.covariances[target] = registration::plane_ellipse(p.normal, covariance_floor_);
    }
    return;
  }
  const Eigen::Matrix3f axes = R_local_world_ * Eigen::Quaternionf(g.rotation[0], g.rotation[1],
                                                                   g.rotation[2], g.rotation[3])
                                                    .normalized()
                                                    .toRotationMatrix();
  Eigen::Vector3f log_scale(g.log_scale[0], g.log_scale[1], g.log_scale[2]);
  Eigen::Index thin = 0;
  log_scale.minCoeff(&thin);
  p.point = R_local_world_ * Eigen::Vector3f(g.mean[0], g.mean[1], g.mean[2]) + t_local_world_;
  p.normal = axes.col(thin);
  if (p.normal.dot(R_local_world_ * anchor.normal) < 0) p.normal = -p.normal;
  if (!p.point.allFinite() || !p.normal.allFinite()) p.variance_m2 = 0;
  if (!with_ellipses_) return;
  if (scale_sigmas_ > 0 && anchor.sigma_n_m > 0) {
    log_scale = log_scale.cwiseMax(std::log(scale_sigmas_ * anchor.sigma_n_m));
  }
  Eigen::Vector3f sorted = log_scale;
  std::sort(sorted.data(), sorted.data() + 3);
  const Eigen::Vector3f values =
      (2 * (log_scale.array() - sorted[1])).exp().matrix().cwiseMax(covariance_floor_);
  cloud_.covariances[target] = axes * values.asDiagonal() * axes.transpose();
}

void SnapshotTargets::update(const LocalPast& past, const map::SnapshotPtr& snapshot) {
  before_.follow(past);
  if (!snapshot || snapshot->gaussians.empty()) return;
  if (has_snapshot_ && snapshot->version == version_) return;
  SGS_CHECK(snapshot->anchors.size() == snapshot->gaussians.size(), "anchors without Gaussians");
  const bool first = !has_snapshot_;
  has_snapshot_ = true;
  version_ = snapshot->version;
  if (first || !assign_targets(*snapshot)) {
    // A fresh layout also tells the search that this is no longer the cloud it knew.
    cloud_.layout += 1;
    cloud_.points.clear();
    cloud_.covariances.clear();
    anchors_.clear();
    target_of_.clear();
    for (std::size_t i = 0; i < snapshot->anchors.size(); ++i) {
      target_of_.push_back(i);
      append(snapshot->anchors[i]);
    }
  }
  ++cloud_.moves;
  for (registration::TargetPoint& p : cloud_.points) p.variance_m2 = 0;
  for (std::size_t i = 0; i < target_of_.size(); ++i) {
    set_target(target_of_[i], snapshot->gaussians[i], snapshot->anchors[i]);
  }
}

}  // namespace sgs::alignment
