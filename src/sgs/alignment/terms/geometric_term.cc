// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/alignment/terms/geometric_term.h"

#include <algorithm>
#include <cmath>

#include "sgs/camera/depth_lag.h"

namespace sgs::alignment {

using registration::FrameMotion;
using registration::make_sampler;
using registration::ReadoutMotion;

namespace {

// Points as the middle row's camera sees them, given as each row's camera does. `change` is small,
// and so what it does is linear: corrections may be applied one after the other.
void move_points(registration::SourceCloud& cloud, const Vector6d& readout, const Vector6d& lag,
                 int height) {
  if (readout.isZero(0) && lag.isZero(0)) return;
  const ReadoutMotion during(readout), since_colour(lag);
  const bool lags = !lag.isZero(0);
  for (registration::SourcePoint& p : cloud.points) {
    const float offset = ReadoutMotion::offset(static_cast<float>(p.v), height);
    p.point = during.to_middle(p.point, offset);
    p.normal = during.direction_to_middle(p.normal, offset);
    if (!lags) continue;
    p.point = since_colour.to_middle(p.point, 1);
    p.normal = since_colour.direction_to_middle(p.normal, 1);
  }
}

// By how much a motion shifts points at a usual distance.
double displacement_m(const SE3& motion) {
  constexpr double kDistance_m = 2;
  return motion.t.norm() + kDistance_m * motion.angle();
}

bool needs_ellipses(const GeometryConfig& config) {
  return config.factor.type == registration::FactorType::kGicp;
}

/// Keeps the points for which `keep` holds, each with its ellipse.
template <class Keep>
void keep_where(registration::SourceCloud& cloud, const Keep& keep) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    if (!keep(cloud.points[i])) continue;
    cloud.points[kept] = cloud.points[i];
    if (!cloud.covariances.empty()) cloud.covariances[kept] = cloud.covariances[i];
    ++kept;
  }
  cloud.points.resize(kept);
  if (!cloud.covariances.empty()) cloud.covariances.resize(kept);
}

}  // namespace

GeometricTerm::GeometricTerm(const GeometryConfig& config, const PinholeCamera& camera,
                             const SE3& T_local_world)
    : config_(config),
      camera_(camera),
      source_sampler_(make_sampler(config.points, camera, needs_ellipses(config))),
      search_(registration::make_search(config.search, camera)),
      targets_(make_target_map(config, T_local_world, camera.fx)),
      cost_(config.factor),
      coarse_cost_(config.factor),
      trial_(config.movers.trial_s) {
  registration::SamplingConfig target_points = config.points;
  target_points.step_px = config.target.step_px;
  target_sampler_ = make_sampler(target_points, camera, needs_ellipses(config));
}

void GeometricTerm::set_frame(const RgbdFrame& frame, const LocalPast& past,
                              const map::SnapshotPtr& snapshot) {
  source_sampler_->sample(frame.depth, source_);
  targets_->update(past, snapshot);
  depth_ = &frame.depth;
  frame_ = frame.index;
  time_s_ = frame.timestamp_s;
  movers_ = 0;
  moving_ = {};
  prepared_ = false;
  T_searched_.reset();
  motion_ = {};
  coarse_source_.points.clear();
  coarse_source_.covariances.clear();
}

void GeometricTerm::set_motion(const FrameMotion& motion) {
  const Vector6d readout = motion.readout - motion_.readout, lag = motion.lag() - motion_.lag();
  motion_ = motion;
  if (readout.isZero(0) && lag.isZero(0)) return;
  move_points(source_, readout, lag, depth_->height());
  coarse_source_.points.clear();
  coarse_source_.covariances.clear();
}

void GeometricTerm::set_moving(const registration::CellMask& moving) {
  if (!moving.any() && !moving_.any()) return;
  moving_ = moving;
  T_searched_.reset();  // the matches are others
}

void GeometricTerm::prepare(const SE3& T_local_predicted) {
  SGS_CHECK(has_targets(), "no targets to search in");
  search_->prepare(targets_->cloud(), T_local_predicted);
  T_reference_local_ = search_->T_local_reference().inverse();
  T_searched_.reset();
  prepared_ = true;
}

registration::Linearization GeometricTerm::linearize(const SE3& T_local_camera) {
  SGS_CHECK(prepared_, "prepare() comes first");
  const SE3 T = in_reference(T_local_camera);
  if (T_searched_ && displacement_m(T_searched_->inverse() * T) < config_.search.keep_matches_m) {
    return cost_.relinearize(source_, *search_, T);
  }
  T_searched_ = T;
  return cost_.linearize(source_, *search_, T, moving_);
}

registration::Linearization GeometricTerm::linearize_coarse(const SE3& T_local_camera, int stride) {
  SGS_CHECK(prepared_, "prepare() comes first");
  if (coarse_source_.points.empty()) {
    for (std::size_t i = 0; i < source_.points.size(); i += static_cast<std::size_t>(stride)) {
      coarse_source_.points.push_back(source_.points[i]);
      if (!source_.covariances.empty()) {
        coarse_source_.covariances.push_back(source_.covariances[i]);
      }
    }
  }
  auto sum =
      coarse_cost_.linearize(coarse_source_, *search_, in_reference(T_local_camera), moving_);
  sum.H *= stride;
  sum.b *= stride;
  sum.error *= stride;
  sum.inliers *= stride;
  return sum;
}

double GeometricTerm::error(const SE3& T_local_camera) const {
  return cost_.error(source_, *search_, in_reference(T_local_camera));
}

double GeometricTerm::overlap(const SE3& T_local_camera) const {
  const double of_all = cost_.overlap(source_, *search_, in_reference(T_local_camera),
                                      config_.keyframe.overlap_distance_m);
  if (movers_ == 0) return of_all;
  const auto all = static_cast<double>(source_.points.size());
  return std::min(1.0, of_all * all / std::max(1.0, all - static_cast<double>(movers_)));
}

bool GeometricTerm::stands_in_free_space(const Eigen::Vector3f& point,
                                         const SE3& T_reference_camera) const {
  const Eigen::Vector3f there =
      T_reference_camera.R.cast<float>() * point + T_reference_camera.t.cast<float>();
  const auto margin_m = static_cast<float>(config_.movers.margin_m) +
                        static_cast<float>(config_.movers.margin_ratio) * point.z();
  return search_->stands_before(there, margin_m);
}

bool GeometricTerm::is_moving(const Eigen::Vector3f& point) const {
  if (!moving_.any()) return false;
  const Eigen::Vector2d at = camera_.project(point.cast<double>());
  const int u = static_cast<int>(std::lround(at.x())), v = static_cast<int>(std::lround(at.y()));
  return u >= 0 && v >= 0 && u < camera_.width && v < camera_.height && moving_.at(u, v);
}

bool GeometricTerm::moves(const Eigen::Vector3f& point, const SE3& T_local_camera) const {
  if (is_moving(point)) return true;
  if (!config_.movers.ignore || !prepared_) return false;
  if (!stands_in_free_space(point, in_reference(T_local_camera))) return false;
  return !trial_.stayed((T_local_camera * point.cast<double>()).cast<float>(), time_s_);
}

double GeometricTerm::count_movers(const SE3& T_local_camera) {
  movers_ = 0;
  if ((!config_.movers.ignore && !moving_.any()) || source_.points.empty()) return 0;
  for (const registration::SourcePoint& p : source_.points) {
    movers_ += moves(p.point, T_local_camera) ? 1 : 0;
  }
  return static_cast<double>(movers_) / static_cast<double>(source_.points.size());
}

void GeometricTerm::note_movers(const SE3& T_local_camera) {
  constexpr std::int64_t kForgetsEvery = 30;  // frames
  if (!config_.movers.ignore || !prepared_) return;
  const SE3 T = in_reference(T_local_camera);
  for (const registration::SourcePoint& p : source_.points) {
    if (!stands_in_free_space(p.point, T)) continue;
    trial_.see((T_local_camera * p.point.cast<double>()).cast<float>(), time_s_);
  }
  if (frame_ % kForgetsEvery == 0) trial_.forget(time_s_);
}

GeometricTerm::MatchedTargets GeometricTerm::matched_targets() const {
  MatchedTargets out;
  const auto targets = search_->targets();
  for (int k : cost_.matches()) {
    if (k < 0) continue;
    const registration::TargetPoint& target = targets[static_cast<std::size_t>(k)];
    out.indices.push_back(k);
    out.normals.push_back(target.normal);
    out.opacities.push_back(target.opacity);
  }
  return out;
}

degeneracy::SurfaceInformation GeometricTerm::surface_information(int noise_stride) {
  sample_points_.clear();
  sample_normals_.clear();
  sample_weights_.clear();
  sample_noise_.clear();
  for (const registration::SourcePoint& p : source_.points) {
    if (is_moving(p.point)) continue;
    sample_points_.push_back(p.point);
    sample_normals_.push_back(p.normal);
    sample_weights_.push_back(1 / p.variance_m2);
    sample_noise_.push_back(p.normal_sigma);
  }
  return degeneracy::accumulate({sample_points_, sample_normals_, sample_weights_, sample_noise_},
                                noise_stride);
}

registration::InverseDepthPlane GeometricTerm::surface_with_colour(int u, int v,
                                                                   const Vector6d& lag) const {
  registration::InverseDepthPlane plane = source_sampler_->inverse_depth_plane(u, v);
  if (!(plane.q > 0) || lag.isZero(0)) return plane;
  const Eigen::Vector3f ray = camera_.back_project(u, v, 1).cast<float>();
  plane.q += depth_lag_per_m(camera_, ray, plane.q, {plane.slope_u, plane.slope_v}, lag);
  return plane;
}

void GeometricTerm::insert_keyframe(const SE3& T_local_camera, const FrameMotion& motion) {
  if (!targets_->wants_keyframes()) return;
  // Denser than the source points: keyframes are rare, and a dense map leaves less of a curved
  // surface between a point and its target.
  target_sampler_->sample(*depth_, keyframe_source_);
  move_points(keyframe_source_, motion.readout, motion.lag(), depth_->height());
  if (config_.keyframe.clear_view && has_targets()) {
    targets_->remove_in(
        registration::FreeSpace(keyframe_source_, camera_, config_.target.step_px), T_local_camera,
        config_.movers.ignore || moving_.any() ? static_cast<float>(config_.movers.clear_m) : 0.0f);
  }
  if (config_.movers.ignore || moving_.any()) {
    keep_where(keyframe_source_,
               [&](const registration::SourcePoint& p) { return !moves(p.point, T_local_camera); });
  }
  targets_->insert(keyframe_source_, {frame_, T_local_camera, motion},
                   prepared_ ? search_.get() : nullptr);
}

}  // namespace sgs::alignment
