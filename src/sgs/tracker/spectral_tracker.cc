// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/tracker/spectral_tracker.h"

#include <algorithm>

#include "sgs/tracker/loss_checks.h"

namespace sgs::tracker {
namespace {
constexpr int kDoubtFrames = 30;  // for so long a picture that does not fit is held against a pose
}  // namespace

SpectralTracker::SpectralTracker(const SpectralConfig& config, const PinholeCamera& camera,
                                 const SE3& T_world_first)
    : config_(config),
      T_world_local_(T_world_first),
      aligner_(config, camera, T_world_first.inverse()),
      relocaliser_(config.relocaliser),
      motion_(config.motion, SE3{}),
      readout_(config.readout) {}

TrackResult SpectralTracker::track(const RgbdFrame& frame, const map::SnapshotPtr& snapshot) {
  const double t = frame.timestamp_s;
  depth_delay_s_ = frame.depth_delay_s;
  aligner_.look_at(frame, snapshot);
  const Alignment alignment = !aligner_.has_map()         ? start_map()
                              : motion_.frames_held() > 0 ? find_camera(frame)
                                                          : follow_unless_elsewhere(frame);
  if (!alignment.trusted()) return lost(alignment, t);
  if (motion_.frames_held() == 0 && !in_doubt()) learn_from(alignment, t);
  motion_.accept(alignment.T_local_camera, t);
  const Vector6d readout = frame_readout(alignment.fit.readout());
  // What geometry alone says just after the picture stopped fitting is not built upon.
  const bool keyframe = !in_doubt() && extend_map(frame, alignment, readout);
  TrackResult result = tracked(alignment);
  result.keyframe = keyframe;
  result.motion = alignment.points_motion;
  result.motion.readout = readout;
  return result;
}

// The first frame is where the tracker was told it is; all it needs is depth.
Alignment SpectralTracker::start_map() const {
  Alignment a;
  a.T_local_camera = motion_.pose();
  a.lost_reason = aligner_.check_frame();
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

// A camera that was carried off between two frames may find surfaces that fit where it is not. Its
// picture does not: where pictures did fit until now, the frame is looked for among the keyframes.
// Surfaces that have drifted may also pull a pose away from what the picture says: then the picture
// alone still fits there.
Alignment SpectralTracker::follow_unless_elsewhere(const RgbdFrame& frame) {
  Alignment followed = follow_camera(frame.timestamp_s);
  poor_frames_ = is_doubtful(followed) ? poor_frames_ + 1 : 0;
  if (!in_doubt()) return followed;
  const bool seen = followed.trusted() && sees_enough(followed);
  if (seen && picture_of_this_place(followed, frame.timestamp_s)) return followed;
  // A frame that shows enough is lost otherwise; a dark one may go on by its surfaces for a while.
  if (seen || (poor_frames_ - 1) % config_.alignment.relocalise_interval == 0) {
    if (const auto elsewhere = relocalised(frame)) return *elsewhere;
  }
  if (followed.trusted() && (seen || !is_explained(followed))) {
    followed.lost_reason = LostReason::kPoorPictureFit;
  }
  return followed;
}

// The frames after a loss: from the pose carried on, and now and then from where the camera is
// found among the keyframes. A camera that has just come back is rather held to be lost than put in
// a wrong place: surfaces are not believed against the picture, but for a place that has become
// dark.
Alignment SpectralTracker::find_camera(const RgbdFrame& frame) {
  constexpr int kPatience = 60;  // frames in a row
  Alignment carried_on = align(T_bridge_, frame.timestamp_s, motion_);
  const bool contradicted =
      carried_on.trusted() && sees_enough(carried_on) && !is_confirmed(carried_on);
  poor_frames_ = contradicted ? poor_frames_ + 1 : 0;
  if (is_confirmed(carried_on)) return carried_on;
  if (carried_on.trusted()) {
    if (contradicted && poor_frames_ <= kPatience) {
      if (auto seen = picture_of_this_place(carried_on, frame.timestamp_s)) return *seen;
    } else if (is_explained(carried_on)) {
      return carried_on;
    }
    carried_on.lost_reason = LostReason::kPoorPictureFit;
  }
  if (motion_.frames_held() % config_.alignment.relocalise_interval != 0) return carried_on;
  return relocalised(frame).value_or(carried_on);
}

// Its picture does not fit as pictures lately did, so that surfaces may deceive.
bool SpectralTracker::is_doubtful(const Alignment& a) const {
  constexpr double kDeceived = 2.5;  // times the usual cost; what noise alone explains is none
  if (usual_visual_cost_ <= 0) return false;
  return !a.picture_holds() || a.picture->mean_cost > std::max(1.0, kDeceived * usual_visual_cost_);
}

// For so long a picture that has stopped fitting is held against the pose; then it has become dark.
bool SpectralTracker::in_doubt() const { return poor_frames_ > 0 && poor_frames_ <= kDoubtFrames; }

// A picture that says something. A few pixels of what is usual fit anywhere.
bool SpectralTracker::sees_enough(const Alignment& a) const {
  constexpr double kShare = 0.2;
  return a.picture && a.picture->pixels >= config_.alignment.min_pixels &&
         a.picture->pixels >= kShare * usual_pixels_;
}

bool SpectralTracker::is_confirmed(const Alignment& a) const {
  return a.trusted() && a.picture_holds() && sees_enough(a) && !is_doubtful(a);
}

// Surfaces cannot agree so far by chance.
bool SpectralTracker::is_explained(const Alignment& a) const {
  constexpr double kMost = 0.6;
  return a.geometry && a.geometry->holds && a.geometry->overlap >= kMost;
}

// Where the picture alone fits, as pictures usually do, near a pose that surfaces have agreed to.
std::optional<Alignment> SpectralTracker::picture_of_this_place(const Alignment& a,
                                                                double timestamp_s) {
  constexpr double kNear_m = 0.1, kNear_rad = 0.1;
  Alignment picture = align_picture(a.T_local_camera, timestamp_s);
  const SE3 T = a.T_local_camera.inverse() * picture.T_local_camera;
  if (!is_confirmed(picture) || T.t.norm() > kNear_m || T.angle() > kNear_rad) return std::nullopt;
  return picture;
}

// From where the keyframes say that the camera is; empty where they do not know, or where neither
// its picture nor features and surfaces together say the same.
std::optional<Alignment> SpectralTracker::relocalised(const RgbdFrame& frame) {
  constexpr double kNotStrange = 1.5;  // cost per pixel
  std::optional<SE3> found;
  {
    const CpuTimer timer(aligner_.times().visual);
    found = relocaliser_.relocalise(frame);
  }
  if (!found) return std::nullopt;
  // The jump is what relocalisation is for: judge the alignment as a motion from there.
  MotionModel motion = motion_;
  motion.jump_to(*found);
  const std::size_t last = aligner_.vision().newest_keyframe();
  aligner_.carry_to(aligner_.vision().nearest_keyframe(*found));
  Alignment a = align(*found, frame.timestamp_s, motion);
  const bool agreed = a.trusted() && is_explained(a) && a.picture_holds() && sees_enough(a) &&
                      a.picture->mean_cost <= kNotStrange;
  if (!is_confirmed(a) && !agreed) {
    aligner_.carry_to(last);
    return std::nullopt;
  }
  motion_ = motion;
  poor_frames_ = 0;
  return a;
}

// The picture fits much worse than pictures lately did: perhaps not where the camera is.
bool SpectralTracker::fits_badly(const Alignment& a) const {
  return usual_visual_cost_ > 0 && a.picture &&
         a.picture->mean_cost > config_.alignment.suspicious_cost * usual_visual_cost_;
}

// Aligns from one start pose; `motion` tells which poses are possible.
Alignment SpectralTracker::align(const SE3& T_start, double timestamp_s,
                                 const MotionModel& motion) {
  Alignment a = aligner_.align(T_start, readout_model(timestamp_s, motion));
  if (a.trusted()) a.lost_reason = motion.judge(a.T_local_camera);
  return a;
}

Alignment SpectralTracker::align_picture(const SE3& T_start, double timestamp_s) {
  Alignment a = aligner_.align_picture(T_start, readout_model(timestamp_s, motion_));
  if (a.trusted()) a.lost_reason = motion_.judge(a.T_local_camera);
  return a;
}

ReadoutModel SpectralTracker::readout_model(double timestamp_s, const MotionModel& motion) const {
  return {[this, timestamp_s, &motion](const SE3& T_local_camera) {
            return readout_.predict(motion.rate_to(T_local_camera, timestamp_s),
                                    aligner_.vision().newest_keyframe());
          },
          [this, timestamp_s, &motion](const Vector6d& seen, const SE3& T_local_camera) {
            return frame_motion(seen, motion.rate_to(T_local_camera, timestamp_s));
          }};
}

// Camera twist over the readout of the frame: what is seen, without the keyframe's share.
Vector6d SpectralTracker::frame_readout(const Vector6d& seen) const {
  Vector6d readout = seen;
  readout.head<3>() -= readout_.keyframe_error(aligner_.vision().newest_keyframe());
  return readout;
}

registration::FrameMotion SpectralTracker::frame_motion(const Vector6d& seen,
                                                        const Vector6d& velocity) const {
  return {frame_readout(seen), velocity, depth_delay_s_};
}

// What this frame's picture tells about the sensor's readout time, and about how well pictures fit.
void SpectralTracker::learn_from(const Alignment& a, double timestamp_s) {
  if (!a.picture_holds()) return;
  const Eigen::Vector3d rate = motion_.rate_to(a.T_local_camera, timestamp_s).head<3>();
  const auto seen = a.fit.measured_readout(a.geometry ? a.geometry->H : Matrix6d(Matrix6d::Zero()));
  readout_.update(rate, seen.rotation, seen.information, aligner_.vision().newest_keyframe());
  constexpr double kForget = 0.1;
  const bool first = usual_visual_cost_ <= 0;
  const auto learn = [&](double& usual, double now) {
    usual = first ? now : usual + kForget * (now - usual);
  };
  learn(usual_visual_cost_, a.picture->mean_cost);
  learn(usual_pixels_, a.picture->pixels);
}

// Targets and visual keyframes grow independently; true when the targets did.
bool SpectralTracker::extend_map(const RgbdFrame& frame, const Alignment& a,
                                 const Vector6d& readout) {
  const CpuTimer timer(aligner_.times().update);
  const auto extended = aligner_.extend(a, readout);
  if (extended.keyframe) {
    relocaliser_.add_keyframe(frame, a.T_local_camera);
    readout_.add_keyframe(aligner_.vision().newest_keyframe(), a.points_motion.velocity.head<3>(),
                          readout.head<3>());
  }
  return extended.targets;
}

void SpectralTracker::correct(const PastCorrection& correction) {
  const PastCorrection local = correction.in_frame(T_world_local_.inverse());
  aligner_.correct(local);
  relocaliser_.correct(local);
  motion_.correct(local.corrected(motion_.pose(), motion_.timestamp_s()));
  T_bridge_ = local.corrected(T_bridge_, motion_.timestamp_s());
}

TrackResult SpectralTracker::tracked(const Alignment& alignment) const {
  TrackResult result;
  result.T_world_camera = (T_world_local_ * alignment.T_local_camera).normalized();
  result.status =
      aligner_.observability().mask != 0 ? TrackingStatus::kDegenerate : TrackingStatus::kOk;
  result.information = alignment.information();
  result.diagnostics = aligner_.describe(alignment);
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
  // Surfaces that were not believed are still the best guess of how the camera went on.
  if (alignment.lost_reason == LostReason::kPoorPictureFit && is_explained(alignment) &&
      motion_.judge(alignment.T_local_camera) == LostReason::kNone) {
    T_bridge_ = alignment.T_local_camera;
  }
  TrackResult result;
  result.status = TrackingStatus::kLost;
  result.lost_reason = alignment.lost_reason;
  result.T_world_camera = (T_world_local_ * T_bridge_).normalized();
  result.diagnostics = aligner_.describe(alignment);
  return result;
}

}  // namespace sgs::tracker
