// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/tracker/spectral_tracker.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "sgs/degeneracy/planarity.h"
#include "sgs/degeneracy/spectrum.h"
#include "sgs/tracker/cpu_timer.h"

namespace sgs::tracker {
namespace {

degeneracy::NormalEquations normal_equations(const registration::Linearization& l) {
  return {l.H, l.b, 0.5 * l.error};
}

/// -H^-1 b, shortened to the caps; zero when there is no finite solution.
Vector6d capped_step(const degeneracy::NormalEquations& system,
                     const registration::SolverConfig& config) {
  Vector6d xi = -system.H.ldlt().solve(system.b);
  if (!xi.allFinite()) return Vector6d::Zero();
  const double longest =
      std::max(xi.head<3>().norm() / config.max_step_rad, xi.tail<3>().norm() / config.max_step_m);
  return longest > 1 ? Vector6d(xi / longest) : xi;
}

bool is_small(const Vector6d& xi, const registration::SolverConfig& config) {
  return xi.head<3>().norm() < config.stop_rad && xi.tail<3>().norm() < config.stop_m;
}

}  // namespace

SpectralTracker::SpectralTracker(const TrackerConfig& config, const PinholeCamera& camera,
                                 const SE3& T_world_first)
    : config_(config),
      remove_(config.fusion == "remove"),
      T_world_map_(T_world_first),
      geometry_(config, camera, T_world_first.inverse()),
      vision_(config.photometric, config.spectral),
      relocaliser_(config.spectral, config.orb, config.visual_pose),
      motion_(config.motion, SE3{}),
      readout_(config.readout) {}

TrackResult SpectralTracker::track(const RgbdFrame& frame, const map::SnapshotPtr& snapshot) {
  Diagnostics d;
  {
    const CpuTimer timer(d.ms_points);
    geometry_.set_frame(frame, snapshot);
    observe_geometry(d);
  }
  {
    const CpuTimer timer(d.ms_visual);
    vision_.set_frame(frame);
  }
  const bool first = !geometry_.has_targets() && vision_.keyframes() == 0;
  Outcome outcome{motion_.pose(), d.source_points >= config_.loss.min_points};
  if (!first) {
    const double t = frame.timestamp_s;
    outcome = align(lost_frames_ > 0 ? T_bridge_ : motion_.predict(t), t, d);
    if (lost_frames_ == 0 && (!outcome.trusted || fits_badly(d))) {
      outcome = align_again(outcome, t, d);
    }
    if (!outcome.trusted) outcome = recover(frame, d);
  }
  if (!outcome.trusted) return lost(frame.timestamp_s, d);

  if (!first && lost_frames_ == 0) {
    learn_readout(outcome.T_map_camera, frame.timestamp_s, d);
    constexpr double kForget = 0.1;
    if (d.prior_source == "photometric") {
      if (usual_visual_cost_ <= 0) usual_visual_cost_ = d.visual_cost;
      usual_visual_cost_ += kForget * (d.visual_cost - usual_visual_cost_);
    }
  }
  d.readout_s = readout_.readout_s();
  if (lost_frames_ > 0) motion_.hold();  // whatever the velocity was, it is over
  lost_frames_ = 0;
  motion_.accept(outcome.T_map_camera, frame.timestamp_s);

  TrackResult result;
  {
    const CpuTimer timer(d.ms_update);
    result.keyframe = extend_map(frame, outcome.T_map_camera, d);
  }
  result.T_world_camera = (T_world_map_ * outcome.T_map_camera).normalized();
  result.status = d.degenerate_mask != 0 ? TrackingStatus::kDegenerate : TrackingStatus::kOk;
  result.diagnostics = d;
  return result;
}

// The picture fits much worse than pictures lately did: perhaps not where the camera is.
bool SpectralTracker::fits_badly(const Diagnostics& d) const {
  return usual_visual_cost_ > 0 &&
         d.visual_cost > config_.spectral.suspicious_cost * usual_visual_cost_;
}

// The prediction may have been the problem (an abrupt stop, a jerk between dropped frames): once
// more from the last pose. The better of the two counts.
SpectralTracker::Outcome SpectralTracker::align_again(const Outcome& first, double timestamp_s,
                                                      Diagnostics& d) {
  const double first_cost = d.visual_cost;
  const Outcome second = align(motion_.pose(), timestamp_s, d);
  if (!first.trusted || (second.trusted && d.visual_cost < first_cost)) return second;
  return align(first.T_map_camera, timestamp_s, d);
}

// Which axes the frame's own surfaces observe, before anything is matched.
void SpectralTracker::observe_geometry(Diagnostics& d) {
  const auto& points = geometry_.source().points;
  d.source_points = static_cast<int>(points.size());
  surfaces_ = geometry_.surface_information();
  observability_ = degeneracy::observe(surfaces_, config_.degeneracy, hysteresis_);
  for (int k = 0; k < 6; ++k) {
    d.snr[static_cast<std::size_t>(k)] = observability_.snr[k];
    d.weights[static_cast<std::size_t>(k)] = observability_.weights[k];
  }
  d.axes = observability_.camera_axes;
  d.degenerate_mask = observability_.mask;
  constexpr std::size_t kStride = 4;
  std::vector<Eigen::Vector3f> normals;
  for (std::size_t i = 0; i < points.size(); i += kStride) normals.push_back(points[i].normal);
  const std::vector<float> equal(normals.size(), 1.0f);
  if (!normals.empty()) d.planarity = degeneracy::planarity(normals, equal).eta;
}

// Coarse to fine from one start pose.
SpectralTracker::Outcome SpectralTracker::align(const SE3& T_start, double timestamp_s,
                                                Diagnostics& d) {
  const bool use_geometry = geometry_.has_targets() && d.source_points >= config_.loss.min_points;
  {
    const CpuTimer timer(d.ms_index);
    vision_.choose_references(T_start);
    if (use_geometry) geometry_.prepare(T_start);
  }
  Outcome outcome{T_start, false};
  const int coarsest = vision_.has_references() ? vision_.levels() - 1 : 0;
  const auto belief = [&] {
    return readout_.predict(motion_.rate_to(outcome.T_map_camera, timestamp_s),
                            vision_.newest_keyframe());
  };
  vision_.set_readout(belief());
  for (int level = coarsest; level >= 0; --level) {
    if (level < coarsest) vision_.update_belief(belief());
    geometry_.set_readout(frame_readout());
    align_level(level, use_geometry, outcome.T_map_camera, d);
  }
  outcome.trusted = explains_frame(outcome.T_map_camera, use_geometry, d);
  return outcome;
}

void SpectralTracker::align_level(int level, bool use_geometry, SE3& T, Diagnostics& d) {
  for (int i = 0; i < config_.spectral.max_iterations; ++i) {
    ++d.iterations;
    degeneracy::NormalEquations geometry, vision;
    if (use_geometry) {
      const CpuTimer timer(d.ms_geometry);
      geometry =
          normal_equations(level > 0 ? geometry_.linearize_coarse(T, config_.spectral.coarse_stride)
                                     : geometry_.linearize(T));
    }
    const CpuTimer timer(d.ms_visual);
    if (vision_.has_references()) {
      vision = vision_.linearize(level, T);
      // A handful of pixels at a coarse level would only pull the pose somewhere.
      if (vision_.used() < config_.spectral.min_pixels) vision = {};
    }
    const auto joint =
        remove_ ? degeneracy::fuse_removed(geometry, observability_.K, vision, config_.degeneracy)
                : degeneracy::fuse_joint(geometry, vision, config_.degeneracy);
    const Vector6d xi = capped_step(joint, config_.solver);
    T = T * SE3::exp(xi);
    vision_.back_substitute(xi);
    if (is_small(xi, config_.solver)) break;
  }
}

// Whether geometry and vision together pin down all six axes at `T`, and agree with the frame.
bool SpectralTracker::explains_frame(const SE3& T, bool use_geometry, Diagnostics& d) {
  bool geometry_holds = false;
  H_geometry_.setZero();
  if (use_geometry) {
    const CpuTimer timer(d.ms_geometry);
    const auto g = geometry_.linearize(T);
    H_geometry_ =
        degeneracy::fuse_removed(normal_equations(g),
                                 remove_ ? observability_.K : Matrix6d(Matrix6d::Identity()), {},
                                 config_.degeneracy)
            .H;
    d.inliers = g.inliers;
    d.cost = g.error;
    d.overlap = geometry_.overlap(T);
    const auto spectrum = degeneracy::spectrum(g.H);
    for (int k = 0; k < 6; ++k) {
      d.eigenvalues[static_cast<std::size_t>(k)] = spectrum.eigenvalues[k];
    }
    d.condition_number = spectrum.condition_number();
    geometry_holds = d.inliers >= config_.loss.min_inliers &&
                     d.inliers >= config_.loss.min_inlier_share * d.source_points;
  }
  Matrix6d H_vision = Matrix6d::Zero();
  if (vision_.has_references()) {
    const CpuTimer timer(d.ms_visual);
    const auto v = vision_.linearize(0, T);
    d.visual_inliers = vision_.used();
    d.visual_cost = vision_.mean_cost();
    if (vision_.used() >= config_.spectral.min_pixels &&
        vision_.mean_cost() <= config_.spectral.max_mean_cost) {
      const Matrix6d A = surfaces_.camera_from_scaled();
      H_vision = A.transpose() * v.H * A;
      d.prior_source = "photometric";
    }
  }
  d.prior_active = d.degenerate_mask != 0 && d.prior_source == "photometric";
  for (int k = 0; k < 6; ++k) {
    const bool seen = geometry_holds && ((d.degenerate_mask >> k) & 1u) == 0;
    const Vector6d axis = observability_.axes.col(k);
    if (!seen && axis.dot(H_vision * axis) < config_.spectral.min_information) return false;
  }
  const SE3 motion = motion_.pose().inverse() * T;
  constexpr int kMaxGrowth = 4;
  const double growth = std::min(lost_frames_ + 1, kMaxGrowth);
  return T.all_finite() && motion.t.norm() <= growth * config_.motion.max_translation_m &&
         motion.angle() <= growth * config_.motion.max_rotation_rad;
}

// Camera twist over the readout of the frame: what is seen, without the keyframe's share.
Vector6d SpectralTracker::frame_readout() const {
  Vector6d readout = vision_.readout();
  readout.head<3>() -= readout_.keyframe_error(vision_.newest_keyframe());
  return readout;
}

// What this frame's picture tells about the sensor's readout time.
void SpectralTracker::learn_readout(const SE3& T, double timestamp_s, const Diagnostics& d) {
  if (d.prior_source != "photometric") return;
  const Eigen::Vector3d rate = motion_.rate_to(T, timestamp_s).head<3>();
  const auto seen = vision_.measured_readout(H_geometry_);
  readout_.update(rate, seen.rotation, seen.information, vision_.newest_keyframe());
}

// The next frames after a loss: looks for the camera among the keyframes, now and then.
SpectralTracker::Outcome SpectralTracker::recover(const RgbdFrame& frame, Diagnostics& d) {
  Outcome outcome{motion_.pose(), false};
  if (lost_frames_ == 0 || lost_frames_ % config_.spectral.relocalise_interval != 0) return outcome;
  std::optional<SE3> found;
  {
    const CpuTimer timer(d.ms_visual);
    found = relocaliser_.relocalise(frame);
  }
  if (!found) return outcome;
  // The jump is what relocalisation is for: judge the alignment as a motion from there.
  const MotionModel before = motion_;
  motion_ = MotionModel(config_.motion, *found);
  outcome = align(*found, frame.timestamp_s, d);
  if (!outcome.trusted) motion_ = before;
  return outcome;
}

TrackResult SpectralTracker::lost(double timestamp_s, const Diagnostics& d) {
  if (lost_frames_ == 0) lost_since_s_ = timestamp_s;
  ++lost_frames_;
  if (timestamp_s - lost_since_s_ <= config_.spectral.bridge_s || lost_frames_ == 1) {
    T_bridge_ = motion_.predict(timestamp_s);
  }
  TrackResult result;
  result.status = TrackingStatus::kLost;
  result.T_world_camera = (T_world_map_ * T_bridge_).normalized();
  result.diagnostics = d;
  return result;
}

// Targets and visual keyframes grow independently; true when the targets did.
bool SpectralTracker::extend_map(const RgbdFrame& frame, const SE3& T, const Diagnostics& d) {
  const bool enough_depth = d.source_points >= config_.loss.min_points;
  if (enough_depth && vision_.wants_keyframe(T)) {
    const int before = vision_.keyframes();
    vision_.insert_keyframe(T, frame_readout(),
                            [this](int u, int v) { return geometry_.smooth_depth(u, v); });
    if (vision_.keyframes() > before) relocaliser_.add_keyframe(frame, T);
  }
  const bool first = !geometry_.has_targets();
  if (!enough_depth || (!first && !(d.overlap < config_.keyframe.min_overlap))) return false;
  geometry_.insert_keyframe(T);
  return true;
}

}  // namespace sgs::tracker
