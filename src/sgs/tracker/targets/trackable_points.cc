// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/tracker/targets/trackable_points.h"

namespace sgs::tracker {

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
  for (std::size_t i = 0; i < source.points.size(); ++i) {
    const registration::SourcePoint& p = source.points[i];
    if (search && search->occupied(R_search * p.point + t_search, R_search * p.normal,
                                   spacing_.radius_per_m * p.point.z(), spacing_.distance_m)) {
      continue;
    }
    cloud_.points.push_back({R * p.point + t, R * p.normal, p.variance_m2});
    if (with_ellipses) cloud_.covariances.push_back(R * source.covariances[i] * R.transpose());
  }
  keyframes_.push_back({keyframe.timestamp_s, T_local_camera, keyframe.velocity,
                        path_to(T_local_camera), begin, cloud_.points.size()});
  return static_cast<int>(cloud_.points.size() - begin);
}

double TrackablePoints::path_to(const SE3& T_local_camera) const {
  if (keyframes_.empty()) return 0;
  const Keyframe& last = keyframes_.back();
  return last.path_m + (T_local_camera.t - last.T_local_camera.t).norm();
}

int TrackablePoints::remove_in(const registration::FreeSpace& space, const SE3& T_local_camera) {
  constexpr double kLongWay_m = 10;
  const SE3 inverse = T_local_camera.inverse();
  const Eigen::Matrix3f R = inverse.R.cast<float>();
  const Eigen::Vector3f t = inverse.t.cast<float>();
  const double path_m = path_to(T_local_camera);
  int removed = 0;
  for (const Keyframe& keyframe : keyframes_) {
    if (path_m - keyframe.path_m < kLongWay_m) break;
    for (std::size_t i = keyframe.begin; i < keyframe.end; ++i) {
      registration::TargetPoint& p = cloud_.points[i];
      if (!p.alive() || !space.contains(R * p.point + t, spacing_.distance_m / 2)) continue;
      p.variance_m2 = 0;
      ++removed;
    }
  }
  if (removed > 0) ++cloud_.moves;
  return removed;
}

void TrackablePoints::move_keyframe(int keyframe, const SE3& T_local_camera) {
  SGS_CHECK(keyframe >= 0 && keyframe < keyframes(), "no such keyframe");
  Keyframe& k = keyframes_[static_cast<std::size_t>(keyframe)];
  const SE3 motion = T_local_camera * k.T_local_camera.inverse();
  const Eigen::Matrix3f R = motion.R.cast<float>();
  const Eigen::Vector3f t = motion.t.cast<float>();
  for (std::size_t i = k.begin; i < k.end; ++i) {
    registration::TargetPoint& p = cloud_.points[i];
    p.point = R * p.point + t;
    p.normal = R * p.normal;
    if (!cloud_.covariances.empty()) {
      cloud_.covariances[i] = R * cloud_.covariances[i] * R.transpose();
    }
  }
  ++cloud_.moves;
  k.T_local_camera = T_local_camera;
}

void TrackablePoints::change_depth(const Keyframe& keyframe, const DepthChange& change) {
  const Eigen::Matrix3f R = keyframe.T_local_camera.R.cast<float>();
  const Eigen::Vector3f t = keyframe.T_local_camera.t.cast<float>();
  for (std::size_t i = keyframe.begin; i < keyframe.end; ++i) {
    registration::TargetPoint& p = cloud_.points[i];
    Eigen::Vector3f point = R.transpose() * (p.point - t), normal = R.transpose() * p.normal;
    change.apply(point, normal, keyframe.velocity);
    p.point = R * point + t;
    p.normal = R * normal;
  }
}

void TrackablePoints::correct(const PastCorrection& correction) {
  for (int k = 0; k < keyframes(); ++k) {
    const Keyframe& keyframe = keyframes_[static_cast<std::size_t>(k)];
    if (correction.depth) change_depth(keyframe, *correction.depth);
    move_keyframe(k, correction.corrected(keyframe.T_local_camera, keyframe.timestamp_s));
  }
}

}  // namespace sgs::tracker
