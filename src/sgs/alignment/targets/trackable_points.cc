// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/alignment/targets/trackable_points.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace sgs::alignment {
namespace {

/// Numbers of the source's points, tile by tile of the picture, so that neighbours in the list are
/// neighbours in space (registration::TargetBlocks).
std::vector<std::size_t> by_tiles(const registration::SourceCloud& source) {
  constexpr int kTile_px = 64;
  std::vector<std::size_t> order(source.points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto tile = [&](std::size_t i) {
    const registration::SourcePoint& p = source.points[i];
    return std::pair(p.v / kTile_px, p.u / kTile_px);
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return tile(a) < tile(b); });
  return order;
}

}  // namespace

int TrackablePoints::insert(const registration::SourceCloud& source, const Observer& keyframe,
                            const registration::CorrespondenceSearch* search) {
  const SE3& T_local_camera = keyframe.T_local_camera;
  const Eigen::Matrix3f R = T_local_camera.R.cast<float>();
  const Eigen::Vector3f t = T_local_camera.t.cast<float>();
  const SE3 T = search ? search->T_local_reference().inverse() * T_local_camera : SE3{};
  const Eigen::Matrix3f R_search = T.R.cast<float>();
  const Eigen::Vector3f t_search = T.t.cast<float>();
  const bool with_ellipses = !source.covariances.empty();
  const std::size_t begin = cloud_.points.size();
  for (const std::size_t i : by_tiles(source)) {
    const registration::SourcePoint& p = source.points[i];
    if (search && search->occupied(R_search * p.point + t_search, R_search * p.normal,
                                   spacing_.radius_per_m * p.point.z(), spacing_.distance_m)) {
      continue;
    }
    cloud_.points.push_back({R * p.point + t, R * p.normal, p.variance_m2});
    if (with_ellipses) cloud_.covariances.push_back(R * source.covariances[i] * R.transpose());
  }
  keyframes_.push_back(
      {keyframe.frame, keyframe.motion, path_to(T_local_camera), begin, cloud_.points.size()});
  past_.set_tracked(keyframe.frame, T_local_camera);
  const std::size_t added = cloud_.points.size() - begin;
  alive_ += static_cast<std::size_t>(
      std::count_if(cloud_.points.end() - static_cast<std::ptrdiff_t>(added), cloud_.points.end(),
                    [](const registration::TargetPoint& p) { return p.alive(); }));
  if (alive_ > most_points_) remove_farthest(T_local_camera.t);
  // Not before: until here `search` may speak of the points as they lay.
  if (cloud_.points.size() > 2 * alive_) forget_removed();
  return static_cast<int>(added);
}

double TrackablePoints::path_to(const SE3& T_local_camera) const {
  if (keyframes_.empty()) return 0;
  const Keyframe& last = keyframes_.back();
  return last.path_m + (T_local_camera.t - past_.at(last.frame).t).norm();
}

int TrackablePoints::remove_in(const registration::FreeSpace& space, const SE3& T_local_camera,
                               float new_margin_m) {
  constexpr double kLongWay_m = 10;
  const double path_m = path_to(T_local_camera);
  const auto lately =
      std::find_if(keyframes_.begin(), keyframes_.end(),
                   [&](const Keyframe& keyframe) { return path_m - keyframe.path_m < kLongWay_m; });
  const std::size_t old = lately == keyframes_.begin() ? 0 : std::prev(lately)->end;
  const std::size_t end = new_margin_m > 0 ? cloud_.points.size() : old;
  if (end == 0) return 0;
  const SE3 inverse = T_local_camera.inverse();
  const Eigen::Matrix3f R = inverse.R.cast<float>();
  const Eigen::Vector3f t = inverse.t.cast<float>();
  const std::size_t before = alive_;
  blocks_.follow(cloud_);
  const auto behind = [&](const registration::TargetBlocks::Sphere& s) {
    return space.misses(s.centre, s.radius);
  };
  for (const auto& range : blocks_.in_view(space.view(), T_local_camera, behind)) {
    for (std::size_t i = range.begin; i < std::min(range.end, end); ++i) {
      const registration::TargetPoint& p = cloud_.points[i];
      const float margin_m = i < old ? spacing_.distance_m / 2 : new_margin_m;
      if (p.alive() && space.contains(R * p.point + t, margin_m)) remove(i);
    }
  }
  return static_cast<int>(before - alive_);
}

void TrackablePoints::remove(std::size_t point) {
  cloud_.points[point].variance_m2 = 0;
  cloud_.removed.push_back(static_cast<std::int32_t>(point));
  --alive_;
}

void TrackablePoints::remove_farthest(const Eigen::Vector3d& camera_position) {
  std::vector<std::pair<double, std::size_t>> order;  // the farthest first
  for (std::size_t k = 0; k < keyframes_.size(); ++k) {
    order.emplace_back(-(past_.at(keyframes_[k].frame).t - camera_position).squaredNorm(), k);
  }
  std::sort(order.begin(), order.end());
  for (const auto& [distance, k] : order) {
    if (alive_ <= most_points_ - most_points_ / 4) break;
    for (std::size_t i = keyframes_[k].begin; i < keyframes_[k].end; ++i) {
      if (cloud_.points[i].alive()) remove(i);
    }
  }
}

// Removed points keep their places until they are more than the others.
void TrackablePoints::forget_removed() {
  std::size_t kept = 0;
  for (Keyframe& keyframe : keyframes_) {
    const std::size_t begin = kept;
    for (std::size_t i = keyframe.begin; i < keyframe.end; ++i) {
      if (!cloud_.points[i].alive()) continue;
      cloud_.points[kept] = cloud_.points[i];
      if (!cloud_.covariances.empty()) cloud_.covariances[kept] = cloud_.covariances[i];
      ++kept;
    }
    keyframe.begin = begin;
    keyframe.end = kept;
  }
  cloud_.points.resize(kept);
  cloud_.points.shrink_to_fit();
  if (!cloud_.covariances.empty()) cloud_.covariances.resize(kept);
  cloud_.removed.clear();
  ++cloud_.layout;
}

void TrackablePoints::follow(const LocalPast& past) {
  const LocalPast before = std::exchange(past_, past);
  const history::Revision &then = before.revision(), &now = past.revision();
  if (then.number() == now.number()) return;
  const auto change = history::depth_change(then.calibration, now.calibration);
  for (Keyframe& keyframe : keyframes_) {
    const SE3 T_before = before.at(keyframe.frame);
    if (change) change_depth(keyframe, T_before, *change);
    move(keyframe, past.at(keyframe.frame) * T_before.inverse());
  }
  ++cloud_.moves;
}

void TrackablePoints::move(const Keyframe& keyframe, const SE3& T_now_before) {
  const Eigen::Matrix3f R = T_now_before.R.cast<float>();
  const Eigen::Vector3f t = T_now_before.t.cast<float>();
  for (std::size_t i = keyframe.begin; i < keyframe.end; ++i) {
    registration::TargetPoint& p = cloud_.points[i];
    p.point = R * p.point + t;
    p.normal = R * p.normal;
    if (!cloud_.covariances.empty()) {
      cloud_.covariances[i] = R * cloud_.covariances[i] * R.transpose();
    }
  }
}

void TrackablePoints::change_depth(Keyframe& keyframe, const SE3& T_local_camera,
                                   const DepthChange& change) {
  const Vector6d lag = keyframe.motion.recalibrate(change.delay_s());
  const Eigen::Matrix3f R = T_local_camera.R.cast<float>();
  const Eigen::Vector3f t = T_local_camera.t.cast<float>();
  for (std::size_t i = keyframe.begin; i < keyframe.end; ++i) {
    registration::TargetPoint& p = cloud_.points[i];
    Eigen::Vector3f point = R.transpose() * (p.point - t), normal = R.transpose() * p.normal;
    change.apply(point, normal, lag);
    p.point = R * point + t;
    p.normal = R * normal;
  }
}

}  // namespace sgs::alignment
