// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/tracker/spectral_tracker.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "sgs/degeneracy/planarity.h"
#include "sgs/tracker/describe.h"
#include "sgs/tracker/loss_checks.h"

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

// Every fourth normal is plenty.
double planarity_of(const registration::SourceCloud& source) {
  constexpr std::size_t kStride = 4;
  std::vector<Eigen::Vector3f> normals;
  for (std::size_t i = 0; i < source.points.size(); i += kStride) {
    normals.push_back(source.points[i].normal);
  }
  if (normals.empty()) return Diagnostics::kNone;
  const std::vector<float> equal(normals.size(), 1.0f);
  return degeneracy::planarity(normals, equal).eta;
}

}  // namespace

SpectralTracker::SpectralTracker(const SpectralConfig& config, const PinholeCamera& camera,
                                 const SE3& T_world_first)
    : config_(config),
      T_world_local_(T_world_first),
      geometry_(config.geometry, camera, T_world_first.inverse()),
      vision_(config.vision),
      relocaliser_(config.relocaliser),
      motion_(config.motion, SE3{}),
      readout_(config.readout) {}

TrackResult SpectralTracker::track(const RgbdFrame& frame, const map::SnapshotPtr& snapshot) {
  const double t = frame.timestamp_s;
  look_at(frame, snapshot);
  const bool first = !geometry_.has_targets() && vision_.keyframes() == 0;
  const Alignment alignment = first                       ? start_map()
                              : motion_.frames_held() > 0 ? find_camera(frame)
                                                          : follow_camera(t);
  if (!alignment.trusted()) return lost(alignment, t);
  if (motion_.frames_held() == 0) learn_from(alignment, t);
  motion_.accept(alignment.T_local_camera, t);
  const bool keyframe = extend_map(frame, alignment);
  return tracked(alignment, keyframe);
}

// Samples the frame, and tells which axes its own surfaces observe.
void SpectralTracker::look_at(const RgbdFrame& frame, const map::SnapshotPtr& snapshot) {
  times_ = {};
  {
    const CpuTimer timer(times_.points);
    geometry_.set_frame(frame, snapshot);
    surfaces_ = geometry_.surface_information(config_.degeneracy.noise_stride);
    observability_ = degeneracy::observe(surfaces_, config_.degeneracy, hysteresis_);
    planarity_ = planarity_of(geometry_.source());
  }
  const CpuTimer timer(times_.visual);
  vision_.set_frame(frame);
}

bool SpectralTracker::enough_points() const {
  return check_points(source_points(), config_.loss) == LostReason::kNone;
}

// The first frame is where the tracker was told it is; all it needs is depth.
Alignment SpectralTracker::start_map() const {
  Alignment a;
  a.T_local_camera = motion_.pose();
  a.lost_reason = check_points(source_points(), config_.loss);
  return a;
}

// Aligns from the prediction. Where that fails or fits badly, the prediction may have been the
// problem (an abrupt stop, a jerk between dropped frames): once more from the last pose. The better
// of the two counts. The picture of a prediction that stands its ground still fits badly, so that
// one is refined from where it ended, with the references and targets of that pose.
Alignment SpectralTracker::follow_camera(double timestamp_s) {
  Alignment predicted = align(motion_.predict(timestamp_s), timestamp_s, motion_);
  if (predicted.trusted() && !fits_badly(predicted)) return predicted;
  Alignment again = align(motion_.pose(), timestamp_s, motion_);
  const bool better = again.trusted() && again.picture && predicted.picture &&
                      again.picture->mean_cost < predicted.picture->mean_cost;
  if (!predicted.trusted() || better) return again;
  return align(predicted.T_local_camera, timestamp_s, motion_);
}

// The frames after a loss: from the pose carried on, and now and then from where the camera is
// found among the keyframes.
Alignment SpectralTracker::find_camera(const RgbdFrame& frame) {
  Alignment carried_on = align(T_bridge_, frame.timestamp_s, motion_);
  if (carried_on.trusted()) return carried_on;
  if (motion_.frames_held() % config_.alignment.relocalise_interval != 0) return carried_on;
  std::optional<SE3> found;
  {
    const CpuTimer timer(times_.visual);
    found = relocaliser_.relocalise(frame);
  }
  if (!found) return carried_on;
  // The jump is what relocalisation is for: judge the alignment as a motion from there.
  MotionModel motion = motion_;
  motion.jump_to(*found);
  Alignment relocalised = align(*found, frame.timestamp_s, motion);
  if (relocalised.trusted()) motion_ = motion;
  return relocalised;
}

// The picture fits much worse than pictures lately did: perhaps not where the camera is.
bool SpectralTracker::fits_badly(const Alignment& a) const {
  return usual_visual_cost_ > 0 && a.picture &&
         a.picture->mean_cost > config_.alignment.suspicious_cost * usual_visual_cost_;
}

// Coarse to fine from one start pose; `motion` tells which poses are possible.
Alignment SpectralTracker::align(const SE3& T_start, double timestamp_s,
                                 const MotionModel& motion) {
  Alignment a;
  a.T_local_camera = T_start;
  a.lost_reason = LostReason::kNotFinite;
  if (!T_start.all_finite()) return a;
  const bool with_geometry = geometry_.has_targets() && enough_points();
  {
    const CpuTimer timer(times_.index);
    a.fit = vision_.start(T_start);
    if (with_geometry) geometry_.prepare(T_start);
  }
  const auto belief = [&] {
    return readout_.predict(motion.rate_to(a.T_local_camera, timestamp_s),
                            vision_.newest_keyframe());
  };
  const int coarsest = a.fit.has_references() ? vision_.levels() - 1 : 0;
  a.fit.set_readout(belief());
  for (int level = coarsest; level >= 0; --level) {
    if (level < coarsest) a.fit.update_belief(belief());
    a.points_readout = frame_readout(a.fit);
    geometry_.set_readout(a.points_readout);
    align_level(level, with_geometry, a);
  }
  if (with_geometry) a.geometry = geometry_at(a.T_local_camera);
  if (a.fit.has_references()) a.picture = picture_at(a.T_local_camera, a.fit);
  a.lost_reason = judge(a, motion);
  return a;
}

void SpectralTracker::align_level(int level, bool with_geometry, Alignment& a) {
  for (int i = 0; i < config_.alignment.max_iterations; ++i) {
    ++a.iterations;
    degeneracy::NormalEquations geometry, vision;
    if (with_geometry) geometry = linearize_geometry(level, a.T_local_camera);
    const CpuTimer timer(times_.visual);
    if (a.fit.has_references()) {
      vision = a.fit.linearize(level, a.T_local_camera);
      // A handful of pixels at a coarse level would only pull the pose somewhere.
      if (a.fit.used() < config_.alignment.min_pixels) vision = {};
    }
    const auto joint =
        config_.fusion == Fusion::kRemove
            ? degeneracy::fuse_removed(geometry, observability_.K, vision, config_.degeneracy)
            : degeneracy::fuse_joint(geometry, vision, config_.degeneracy);
    const Vector6d xi = capped_step(joint, config_.solver);
    a.T_local_camera = a.T_local_camera * SE3::exp(xi);
    a.fit.back_substitute(xi);
    if (is_small(xi, config_.solver)) break;
  }
}

degeneracy::NormalEquations SpectralTracker::linearize_geometry(int level, const SE3& T) {
  const CpuTimer timer(times_.geometry);
  return normal_equations(level > 0 ? geometry_.linearize_coarse(T, config_.alignment.coarse_stride)
                                    : geometry_.linearize(T));
}

Alignment::Geometry SpectralTracker::geometry_at(const SE3& T) {
  const CpuTimer timer(times_.geometry);
  const auto l = geometry_.linearize(T);
  const Matrix6d K =
      config_.fusion == Fusion::kRemove ? observability_.K : Matrix6d(Matrix6d::Identity());
  Alignment::Geometry g;
  g.inliers = l.inliers;
  g.cost = l.error;
  g.overlap = geometry_.overlap(T);
  g.spectrum = degeneracy::spectrum(l.H);
  g.H = degeneracy::fuse_removed(normal_equations(l), K, {}, config_.degeneracy).H;
  g.holds = check_matches(g.inliers, source_points(), config_.loss) == LostReason::kNone;
  return g;
}

Alignment::Picture SpectralTracker::picture_at(const SE3& T, VisualTerm::Fit& fit) {
  const CpuTimer timer(times_.visual);
  Alignment::Picture p;
  p.H = fit.linearize(0, T).H;
  p.pixels = fit.used();
  p.mean_cost = fit.mean_cost();
  p.holds =
      p.pixels >= config_.alignment.min_pixels && p.mean_cost <= config_.alignment.max_mean_cost;
  return p;
}

// Whether geometry and vision together pin down all six axes, and agree with how cameras move.
LostReason SpectralTracker::judge(const Alignment& a, const MotionModel& motion) const {
  const bool geometry_holds = a.geometry && a.geometry->holds;
  Matrix6d H_vision = Matrix6d::Zero();  // on the scaled and centred twists of the axes
  if (a.picture_holds()) {
    const Matrix6d A = surfaces_.camera_from_scaled();
    H_vision = A.transpose() * a.picture->H * A;
  }
  for (int k = 0; k < 6; ++k) {
    const bool seen = geometry_holds && ((observability_.mask >> k) & 1u) == 0;
    const Vector6d axis = observability_.axes.col(k);
    if (!seen && axis.dot(H_vision * axis) < config_.alignment.min_information) {
      return why_unseen(a);
    }
  }
  return motion.judge(a.T_local_camera);
}

// What kept an axis from being seen: geometry is asked first.
LostReason SpectralTracker::why_unseen(const Alignment& a) const {
  const LostReason points = check_points(source_points(), config_.loss);
  if (points != LostReason::kNone) return points;
  if (!a.geometry || !a.geometry->holds) return LostReason::kTooFewMatches;
  if (!a.picture || a.picture->pixels < config_.alignment.min_pixels) {
    return LostReason::kTooFewPixels;
  }
  return a.picture->holds ? LostReason::kUnseenAxis : LostReason::kPoorPictureFit;
}

// Camera twist over the readout of the frame: what is seen, without the keyframe's share.
Vector6d SpectralTracker::frame_readout(const VisualTerm::Fit& fit) const {
  Vector6d readout = fit.readout();
  readout.head<3>() -= readout_.keyframe_error(vision_.newest_keyframe());
  return readout;
}

// What this frame's picture tells about the sensor's readout time, and about how well pictures fit.
void SpectralTracker::learn_from(const Alignment& a, double timestamp_s) {
  if (!a.picture_holds()) return;
  const Eigen::Vector3d rate = motion_.rate_to(a.T_local_camera, timestamp_s).head<3>();
  const auto seen = a.fit.measured_readout(a.geometry ? a.geometry->H : Matrix6d(Matrix6d::Zero()));
  readout_.update(rate, seen.rotation, seen.information, vision_.newest_keyframe());
  constexpr double kForget = 0.1;
  if (usual_visual_cost_ <= 0) usual_visual_cost_ = a.picture->mean_cost;
  usual_visual_cost_ += kForget * (a.picture->mean_cost - usual_visual_cost_);
}

// Targets and visual keyframes grow independently; true when the targets did.
bool SpectralTracker::extend_map(const RgbdFrame& frame, const Alignment& a) {
  const CpuTimer timer(times_.update);
  if (!enough_points()) return false;
  if (vision_.wants_keyframe(a.T_local_camera, a.fit)) {
    const int before = vision_.keyframes();
    vision_.insert_keyframe(a.T_local_camera, a.fit, frame_readout(a.fit),
                            [this](int u, int v) { return geometry_.smooth_depth(u, v); });
    if (vision_.keyframes() > before) relocaliser_.add_keyframe(frame, a.T_local_camera);
  }
  const bool unexplained =
      a.geometry && a.geometry->overlap < config_.geometry.keyframe.min_overlap;
  if (geometry_.has_targets() && !unexplained) return false;
  geometry_.insert_keyframe(a.T_local_camera, a.points_readout);
  return true;
}

TrackResult SpectralTracker::tracked(const Alignment& alignment, bool keyframe) const {
  TrackResult result;
  result.T_world_camera = (T_world_local_ * alignment.T_local_camera).normalized();
  result.status = observability_.mask != 0 ? TrackingStatus::kDegenerate : TrackingStatus::kOk;
  result.keyframe = keyframe;
  result.diagnostics = describe(alignment);
  result.diagnostics.readout_s = readout_.readout_s();
  return result;
}

TrackResult SpectralTracker::lost(const Alignment& alignment, double timestamp_s) {
  if (motion_.frames_held() == 0) {
    lost_since_s_ = timestamp_s;
    T_bridge_ = motion_.pose();
  }
  motion_.miss();
  const SE3 T_carried_on = motion_.predict(timestamp_s);
  if (T_carried_on.all_finite() &&
      (timestamp_s - lost_since_s_ <= config_.alignment.bridge_s || motion_.frames_held() == 1)) {
    T_bridge_ = T_carried_on;
  }
  TrackResult result;
  result.status = TrackingStatus::kLost;
  result.lost_reason = alignment.lost_reason;
  result.T_world_camera = (T_world_local_ * T_bridge_).normalized();
  result.diagnostics = describe(alignment);
  return result;
}

Diagnostics SpectralTracker::describe(const Alignment& a) const {
  Diagnostics d;
  times_.write_to(d);
  d.source_points = source_points();
  d.targets = static_cast<int>(geometry_.targets().cloud().points.size());
  d.planarity = planarity_;
  note_observability(observability_, d);
  d.iterations = a.iterations;
  if (a.geometry) {
    d.inliers = a.geometry->inliers;
    d.cost = a.geometry->cost;
    d.overlap = a.geometry->overlap;
    note_spectrum(a.geometry->spectrum, d);
  }
  if (a.picture) {
    d.visual_inliers = a.picture->pixels;
    d.visual_cost = a.picture->mean_cost;
  }
  if (a.picture_holds()) d.prior_source = PriorSource::kPhotometric;
  d.prior_active = d.degenerate_mask != 0 && a.picture_holds();
  return d;
}

}  // namespace sgs::tracker
