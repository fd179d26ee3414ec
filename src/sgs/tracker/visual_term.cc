// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/tracker/visual_term.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sgs::tracker {
namespace {

constexpr double kDefaultDepth_m = 2;

double mean_depth(const DepthImage& depth, double max_depth_m) {
  constexpr std::size_t kStride = 37;  // coprime to usual image widths: an even sample
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0; i < depth.size(); i += kStride) {
    const double z = static_cast<double>(depth.data()[i]);
    if (!(z > 0 && z < max_depth_m)) continue;
    sum += z;
    ++count;
  }
  return count > 0 ? sum / count : kDefaultDepth_m;
}

}  // namespace

VisualTerm::VisualTerm(const registration::PhotometricConfig& photometric,
                       const SpectralConfig& config)
    : photometric_(photometric), config_(config) {}

void VisualTerm::set_frame(const RgbdFrame& frame) {
  pyramid_.build(frame.color, frame.camera, photometric_.levels);
  levels_ = pyramid_.levels();
  frame_ = &frame;
}

// How different the view from `T_map_camera` is from a keyframe's: shift of the view's centre in
// image widths, change of distance and roll, half each (TRACKING section 1, finding 6).
double VisualTerm::view_distance(const Keyframe& keyframe, const SE3& T_map_camera) const {
  const PinholeCamera& camera = pyramid_.level(0).camera;
  const SE3 T = keyframe.reference.T_world_keyframe().inverse() * T_map_camera;
  const Eigen::Vector3d centre = T * Eigen::Vector3d(0, 0, keyframe.mean_depth_m);
  constexpr double kNear_m = 0.2, kFarAway = 9;
  if (centre.z() < kNear_m) return kFarAway;
  const double shift = std::hypot(centre.x() / centre.z() * camera.fx / camera.width,
                                  centre.y() / centre.z() * camera.fy / camera.height);
  const double roll = std::acos(std::clamp(T.R(1, 1), -1.0, 1.0));
  return shift + 0.5 * T.t.norm() / keyframe.mean_depth_m + 0.5 * roll;
}

void VisualTerm::choose_references(const SE3& T_map_predicted) {
  references_.clear();
  if (keyframes_.empty()) return;
  const auto add = [this](std::size_t index) { references_.push_back({index, {}, {}}); };
  add(newest_);
  std::vector<std::pair<double, std::size_t>> near;
  for (std::size_t i = 0; i < keyframes_.size(); ++i) {
    if (i == newest_) continue;
    const double distance = view_distance(keyframes_[i], T_map_predicted);
    if (distance < config_.revisit_distance) near.emplace_back(distance, i);
  }
  std::sort(near.begin(), near.end());
  for (const auto& [distance, index] : near) {
    if (static_cast<int>(references_.size()) >= config_.max_references) break;
    add(index);
  }
}

degeneracy::NormalEquations VisualTerm::linearize(int level, const SE3& T_map_camera) {
  degeneracy::NormalEquations sum;
  used_ = 0;
  cost_ = 0;
  for (Reference& r : references_) {
    const auto& reference = keyframes_[r.keyframe].reference;
    if (level >= reference.levels()) continue;
    r.last = registration::linearize(reference, level, pyramid_, frame_->depth, T_map_camera,
                                     r.brightness, photometric_);
    sum.H += r.last.H;
    sum.b += r.last.b;
    sum.cost += r.last.cost;
    used_ += r.last.used;
    cost_ += r.last.cost;
    if (r.keyframe == newest_) {
      newest_share_ = static_cast<double>(r.last.used) /
                      static_cast<double>(std::max<std::size_t>(1, reference.points(level).size()));
    }
  }
  return sum;
}

void VisualTerm::move_brightness(const Vector6d& xi) {
  for (Reference& r : references_) r.brightness = r.last.updated(r.brightness, xi);
}

// Within `share` of the limits that make a new keyframe.
bool VisualTerm::is_near(const Keyframe& keyframe, const SE3& T_map_camera, double share) const {
  const SE3 T = keyframe.reference.T_world_keyframe().inverse() * T_map_camera;
  return T.t.norm() < share * config_.keyframe_translation * keyframe.mean_depth_m &&
         T.angle() < share * config_.keyframe_rotation_deg * std::numbers::pi / 180;
}

bool VisualTerm::wants_keyframe(const SE3& T_map_camera) const {
  return keyframes_.empty() || !is_near(keyframes_[newest_], T_map_camera, 1.0) ||
         newest_share_ < config_.keyframe_visible;
}

void VisualTerm::insert_keyframe(const SE3& T_map_camera,
                                 const registration::DepthLookup& smooth_depth) {
  constexpr double kSameView = 0.8;
  for (const Reference& r : references_) {
    if (r.keyframe == newest_ || !is_near(keyframes_[r.keyframe], T_map_camera, kSameView))
      continue;
    const auto points = keyframes_[r.keyframe].reference.points(0).size();
    if (r.last.used < config_.keyframe_visible * static_cast<double>(points)) continue;
    newest_ = r.keyframe;
    return;
  }
  keyframes_.push_back({registration::PhotometricReference(pyramid_, frame_->depth, T_map_camera,
                                                           photometric_, smooth_depth),
                        mean_depth(frame_->depth, photometric_.max_depth_m)});
  newest_ = keyframes_.size() - 1;
}

}  // namespace sgs::tracker
