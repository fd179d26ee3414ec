// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/tracker/spectral_tracker.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sgs/alignment/loss_checks.h"
#include "sgs/camera/movers.h"
#include "sgs/camera/resample.h"

namespace sgs::tracker {
namespace {

LossPolicy::Limits loss_limits(const alignment::AlignmentConfig& config) {
  LossPolicy::Limits limits;
  limits.min_pixels = config.min_pixels;
  limits.search_interval = config.relocalise_interval;
  return limits;
}

/// Whether a hand may have carried a camera so in that time.
bool is_possible(const SE3& motion, double seconds) {
  constexpr double kSoon_s = 0.5;
  constexpr double kFastest_mps = 1.5, kFastest_radps = 2.5, kNoise_m = 0.03, kNoise_rad = 0.03;
  return std::abs(seconds) <= kSoon_s &&
         motion.t.norm() <= kNoise_m + kFastest_mps * std::abs(seconds) &&
         motion.angle() <= kNoise_rad + kFastest_radps * std::abs(seconds);
}

}  // namespace

SpectralTracker::SpectralTracker(const SpectralConfig& config, const PinholeCamera& camera,
                                 const SE3& T_world_first)
    : config_(config),
      camera_(camera),
      T_world_local_(T_world_first),
      aligner_(config.aligner, camera, T_world_first.inverse()),
      relocaliser_(config.relocaliser),
      policy_(loss_limits(config.aligner.alignment)),
      motion_(config.motion, SE3{}),
      readout_(config.readout),
      delay_(config.delay) {}

TrackResult SpectralTracker::track(const RgbdFrame& frame, const history::Revision& revision,
                                   const map::SnapshotPtr& snapshot) {
  const double t = frame.timestamp_s;
  const history::Revision before = aligner_.past().revision();
  aligner_.look_at(frame, revision, snapshot);
  if (before.number() != revision.number()) follow(before.calibration);
  depth_delay_s_ = frame.depth_delay_s + delay_.delay_s();
  const alignment::Alignment alignment = !is_in_map()          ? look_for_place(frame)
                                         : !aligner_.has_map() ? start_map()
                                         : motion_.frames_held() > 0
                                             ? find_camera(frame)
                                             : follow_unless_elsewhere(frame);
  if (!alignment.trusted()) return lost(alignment, t);
  const Vector6d rate = motion_.rate_to(alignment.T_local_camera, t);
  if (motion_.frames_held() == 0 && !policy_.in_doubt()) learn_from(alignment, rate);
  motion_.accept(alignment.T_local_camera, t);
  aligner_.remember(alignment);
  trusted_frame_ = frame.index;
  const Vector6d readout = frame_readout(alignment.fit.readout());
  const auto still = aligner_.still_pixels(frame, alignment);
  // What geometry alone says just after the picture stopped fitting is not built upon.
  const bool keyframe = !policy_.in_doubt() && extend_map(frame, still, alignment, readout, rate);
  TrackResult result = tracked(alignment);
  result.keyframe = keyframe;
  result.still = still;
  result.motion = alignment.points_motion;
  result.motion.readout = readout;
  return result;
}

// The first frame is where the tracker was told it is; all it needs is depth.
alignment::Alignment SpectralTracker::start_map() const {
  alignment::Alignment a;
  a.T_local_camera = motion_.pose();
  a.lost_reason = aligner_.check_frame();
  return a;
}

// Aligns from the prediction. Where that fails or fits badly, the prediction may have been the
// problem (an abrupt stop, a jerk between dropped frames): once more from the last pose. The better
// of the two counts. The picture of a prediction that stands its ground still fits badly, so that
// one is refined from where it ended, with the references and targets of that pose.
alignment::Alignment SpectralTracker::follow_camera(double timestamp_s) {
  alignment::Alignment predicted = align(motion_.predict(timestamp_s), timestamp_s, motion_);
  if (predicted.trusted() && !fits_badly(predicted)) return predicted;
  alignment::Alignment again = align(motion_.pose(), timestamp_s, motion_);
  const bool better = again.trusted() && again.picture && predicted.picture &&
                      again.picture->mean_cost < predicted.picture->mean_cost;
  if (!predicted.trusted() || better) return again;
  return align(predicted.T_local_camera, timestamp_s, motion_);
}

// A camera that has drifted on its way back sees an old keyframe where that is not, and a frame
// that has to fit both it and the newest one fits neither. Where the newest one alone still fits,
// the camera is not lost: the drift is for a loop to close.
alignment::Alignment SpectralTracker::without_contradictions(const alignment::Alignment& a,
                                                             double timestamp_s) {
  if (a.fit.references() < 2 || !policy_.is_doubtful(evidence_of(a))) return a;
  alignment::Alignment alone =
      aligner_.align_to_newest(motion_.predict(timestamp_s), readout_model(timestamp_s, motion_));
  if (alone.trusted()) alone.lost_reason = motion_.judge(alone.T_local_camera);
  if (!policy_.is_confirmed(evidence_of(alone))) return a;
  aligner_.leave_out_older(a);
  return alone;
}

// A camera that was carried off between two frames may find surfaces that fit where it is not, and
// surfaces that have drifted may pull a pose away from what the picture says: then the picture
// alone still fits there.
alignment::Alignment SpectralTracker::follow_unless_elsewhere(const RgbdFrame& frame) {
  alignment::Alignment followed =
      without_contradictions(follow_camera(frame.timestamp_s), frame.timestamp_s);
  const Evidence evidence = evidence_of(followed);
  if (policy_.follow(evidence) == LossPolicy::State::kTracking) {
    if (!policy_.wonders(evidence)) return followed;
    const auto is_better = [&](const alignment::Alignment& found) {
      return policy_.is_better(evidence_of(found), evidence);
    };
    return relocalised(frame, is_better).value_or(followed);
  }
  if (policy_.can_be_confirmed(evidence) && picture_of_this_place(followed, frame.timestamp_s)) {
    return followed;
  }
  if (policy_.searches(evidence)) {
    const auto is_right = [&](const alignment::Alignment& found) { return is_found(found); };
    if (const auto elsewhere = relocalised(frame, is_right)) return *elsewhere;
  }
  if (policy_.loses(evidence)) followed.lost_reason = alignment::LostReason::kPoorPictureFit;
  return followed;
}

// The frames after a loss: from the pose carried on, and now and then from where the camera is
// found among the keyframes.
alignment::Alignment SpectralTracker::find_camera(const RgbdFrame& frame) {
  alignment::Alignment carried_on =
      align(T_bridge_, frame.timestamp_s, motion_, alignment::JointAligner::From::kAfar);
  switch (policy_.find(evidence_of(carried_on))) {
    case LossPolicy::Finding::kAccept:
      return carried_on;
    case LossPolicy::Finding::kAskPicture:
      if (auto seen = picture_of_this_place(carried_on, frame.timestamp_s)) return *seen;
      break;
    case LossPolicy::Finding::kLost:
      break;
  }
  if (carried_on.trusted()) carried_on.lost_reason = alignment::LostReason::kPoorPictureFit;
  if (!policy_.searches_lost(motion_.frames_held())) return carried_on;
  const auto is_right = [&](const alignment::Alignment& found) { return is_found(found); };
  return relocalised(frame, is_right).value_or(carried_on);
}

// A view becomes what a frame becomes that was tracked to its place; and its picture teaches what
// pictures cost here.
void SpectralTracker::know(const alignment::KnownView& view, const history::Revision& revision) {
  if (!search_) {
    search_.emplace();
    search_->needed_inliers = config_.relocaliser.pose.relocalisation_min_inliers;
    if (revision.calibration) delay_.shift(0, revision.calibration->delay_sigma_s);
  }
  view_times_s_.push_back(view.timestamp_s);
  RgbdFrame frame = resampled(view.frame, camera_);
  frame.index = revision.path.back().frame;
  relocaliser_.know(view, frame);
  aligner_.look_at(frame, revision, nullptr);
  alignment::Alignment a;
  a.T_local_camera = aligner_.past().at(frame.index);
  // Of a drawing the picture alone is taken: what it shows is known already, and how drawings fit
  // says nothing of how pictures do.
  if (view.drawn) {
    aligner_.take_drawing(a.T_local_camera);
    readout_.add_keyframe(aligner_.vision().newest_keyframe(), Eigen::Vector3d::Zero(),
                          Eigen::Vector3d::Zero());
    return;
  }
  if (aligner_.has_map()) {
    aligner_.carry_to(aligner_.vision().nearest_keyframe(a.T_local_camera));
    a = aligner_.measure(a.T_local_camera, alignment::known_readout(view.motion));
    aligner_.learn_noise(a);
    policy_.learn(evidence_of(a));
  }
  a.points_motion = view.motion;
  if (aligner_.extend(a, view.motion.readout).keyframe) {
    readout_.add_keyframe(aligner_.vision().newest_keyframe(), view.motion.velocity.head<3>(),
                          view.motion.readout.head<3>());
  }
}

// A camera that has not found itself in its map could be anywhere: it is not carried on.
alignment::Alignment SpectralTracker::look_for_place(const RgbdFrame& frame) {
  if (aligner_.check_frame() == alignment::LostReason::kNone) {
    const double t = frame.timestamp_s;
    const auto is_right = [&](const alignment::Alignment& place) {
      return is_first_place(place, t);
    };
    const auto found = relocalised(frame, is_right);
    note_look(t);
    if (found) {
      search_->found = true;
      return *found;
    }
  }
  alignment::Alignment a;
  a.T_local_camera = motion_.pose();
  a.lost_reason = alignment::LostReason::kNotInMap;
  return a;
}

void SpectralTracker::note_look(double timestamp_s) {
  const Relocaliser::Look& look = relocaliser_.last_look();
  PlaceSearch& best = *search_;
  ++best.looks;
  const auto nearness = [](int inliers, int matches) { return std::pair(inliers, matches); };
  if (nearness(look.inliers, look.matches) <= nearness(best.best_inliers, best.best_matches))
    return;
  best.best_inliers = look.inliers;
  best.best_matches = look.matches;
  best.best_frame_s = timestamp_s;
  const std::int64_t view = look.keyframe - alignment::known_view_index(0);
  const bool known = view >= 0 && view < std::ssize(view_times_s_);
  best.best_view_s = known ? view_times_s_[static_cast<std::size_t>(view)] : 0;
}

// Whether a place that features have found is right in a map that the camera has not been seen in
// yet: surfaces and picture have to say so both, and a second frame has to see itself next to it.
// Who sees the map from farther away sees much that it does not show: then less has to be explained
// by surfaces, where hardly a feature that is alike contradicts the others.
bool SpectralTracker::is_first_place(const alignment::Alignment& a, double timestamp_s) {
  constexpr double kPartlyExplained = 0.35, kUnanimous = 0.8;
  const Relocaliser::Look& look = relocaliser_.last_look();
  const Evidence evidence = evidence_of(a);
  const bool seen_from_afar = a.geometry && a.geometry->holds &&
                              a.geometry->overlap >= kPartlyExplained &&
                              look.inliers >= kUnanimous * look.matches;
  // A drawing of the map is soft, and no picture fits it as pictures fit each other.
  const bool as_drawn = a.fit.to_drawing() && evidence.trusted && evidence.explained_by_surfaces &&
                        look.inliers >= kUnanimous * look.matches;
  if (!(policy_.is_found(evidence) || as_drawn) || !evidence.picture_holds ||
      !(evidence.explained_by_surfaces || seen_from_afar)) {
    ++search_->refused;
    return false;
  }
  const auto before = std::exchange(sighting_, Sighting{a.T_local_camera, timestamp_s});
  return before && is_possible(before->T_local_camera.inverse() * a.T_local_camera,
                               timestamp_s - before->timestamp_s);
}

Evidence SpectralTracker::evidence_of(const alignment::Alignment& a) const {
  constexpr double kExplained = 0.6;  // surfaces cannot agree so far by chance
  Evidence e;
  e.trusted = a.trusted();
  e.explained_by_surfaces = a.geometry && a.geometry->holds && a.geometry->overlap >= kExplained;
  e.surfaces_see_all_axes = aligner_.observability().mask == 0;
  e.picture_holds = a.picture_holds();
  if (a.picture) {
    e.pixels = a.picture->pixels;
    e.cost = a.picture->mean_cost;
  }
  return e;
}

// Where the picture alone fits, as pictures usually do, near a pose that surfaces have agreed to.
std::optional<alignment::Alignment> SpectralTracker::picture_of_this_place(
    const alignment::Alignment& a, double timestamp_s) {
  constexpr double kNear_m = 0.1, kNear_rad = 0.1;
  alignment::Alignment picture = align_picture(a.T_local_camera, timestamp_s);
  const SE3 T = a.T_local_camera.inverse() * picture.T_local_camera;
  if (!policy_.is_confirmed(evidence_of(picture)) || T.t.norm() > kNear_m || T.angle() > kNear_rad)
    return std::nullopt;
  return picture;
}

// From where the keyframes say that the camera is; empty where they do not know, or where what is
// seen there is not believed.
std::optional<alignment::Alignment> SpectralTracker::relocalised(
    const RgbdFrame& frame, const std::function<bool(const alignment::Alignment&)>& is_believed) {
  std::optional<SE3> found;
  {
    const alignment::CpuTimer timer(aligner_.times().visual);
    found = relocaliser_.relocalise(frame, aligner_.past());
  }
  if (!found) return std::nullopt;
  // The jump is what relocalisation is for: judge the alignment as a motion from there.
  MotionModel motion = motion_;
  motion.jump_to(*found);
  const std::size_t last = aligner_.vision().newest_keyframe();
  const bool drawn = relocaliser_.last_look().drawn;
  aligner_.carry_to(aligner_.vision().nearest_keyframe(*found, drawn));
  alignment::Alignment a =
      align(*found, frame.timestamp_s, motion, alignment::JointAligner::From::kAfar);
  if (!is_believed(a)) {
    aligner_.carry_to(last);
    return std::nullopt;
  }
  motion_ = motion;
  policy_.found();
  return a;
}

// The picture fits much worse than pictures lately did: perhaps not where the camera is.
bool SpectralTracker::fits_badly(const alignment::Alignment& a) const {
  return policy_.usual_cost() > 0 && a.picture &&
         a.picture->mean_cost > config_.aligner.alignment.suspicious_cost * policy_.usual_cost();
}

// Aligns from one start pose; `motion` tells which poses are possible.
alignment::Alignment SpectralTracker::align(const SE3& T_start, double timestamp_s,
                                            const MotionModel& motion,
                                            alignment::JointAligner::From from) {
  alignment::Alignment a = aligner_.align(T_start, readout_model(timestamp_s, motion), from);
  if (a.trusted()) a.lost_reason = motion.judge(a.T_local_camera);
  return a;
}

alignment::Alignment SpectralTracker::align_picture(const SE3& T_start, double timestamp_s) {
  alignment::Alignment a = aligner_.align_picture(T_start, readout_model(timestamp_s, motion_));
  if (a.trusted()) a.lost_reason = motion_.judge(a.T_local_camera);
  return a;
}

alignment::ReadoutModel SpectralTracker::readout_model(double timestamp_s,
                                                       const MotionModel& motion) const {
  return {[this, timestamp_s, &motion](const SE3& T_local_camera) {
            return readout_.predict(motion.rate_to(T_local_camera, timestamp_s),
                                    aligner_.vision().newest_keyframe());
          },
          // Where depth is the older half of the frame, not the rate to the pose that is looked
          // for: points that follow a pose's own velocity backwards make it swing to and fro.
          // Forwards they damp it, and a rate of the frames before is late by a degree where a
          // hand turns fast (docs/decisions/0076-the-velocity-of-a-frame.md).
          [this, timestamp_s, &motion](const Vector6d& seen, const SE3& T_local_camera) {
            const Vector6d velocity = depth_delay_s_ > 0
                                          ? motion.rate_to(T_local_camera, timestamp_s)
                                          : motion.steady_rate();
            return registration::FrameMotion{frame_readout(seen), velocity, depth_delay_s_,
                                             delay_.delay_s()};
          }};
}

// Camera twist over the readout of the frame: what is seen, without the keyframe's share.
Vector6d SpectralTracker::frame_readout(const Vector6d& seen) const {
  Vector6d readout = seen;
  readout.head<3>() -= readout_.keyframe_error(aligner_.vision().newest_keyframe());
  return readout;
}

// What this frame tells about the sensor: its readout time, its clocks, its noise, and how well
// pictures fit. `rate`: camera twist per second.
void SpectralTracker::learn_from(const alignment::Alignment& a, const Vector6d& rate) {
  if (!a.picture_holds() || a.fit.to_drawing()) return;
  const auto seen = a.fit.measured_readout(a.geometry ? a.geometry->H : Matrix6d(Matrix6d::Zero()));
  readout_.update(rate.head<3>(), seen.rotation, seen.information,
                  aligner_.vision().newest_keyframe());
  if (a.geometry && a.geometry->holds) {
    delay_.update(a.geometry->H, a.picture->H, a.picture->b, rate);
  }
  aligner_.learn_noise(a);
  policy_.learn(evidence_of(a));
}

// Targets and visual keyframes grow independently; true when the targets did.
bool SpectralTracker::extend_map(const RgbdFrame& frame,
                                 const std::shared_ptr<const PixelMask>& still,
                                 const alignment::Alignment& a, const Vector6d& readout,
                                 const Vector6d& rate) {
  const alignment::CpuTimer timer(aligner_.times().update);
  const auto extended = aligner_.extend(a, readout);
  if (extended.keyframe) {
    const history::CalibrationPtr& calibration = aligner_.past().revision().calibration;
    if (still) {
      RgbdFrame place = frame;
      leave_out_movers(place, still);
      relocaliser_.add_keyframe(place, calibration);
    } else {
      relocaliser_.add_keyframe(frame, calibration);
    }
    readout_.add_keyframe(aligner_.vision().newest_keyframe(), rate.head<3>(), readout.head<3>());
  }
  return extended.targets;
}

// Goes on from where the last frames are believed to be now, the last trusted one and the last one.
void SpectralTracker::follow(const history::CalibrationPtr& before) {
  const alignment::LocalPast& past = aligner_.past();
  if (const auto change = history::depth_change(before, past.revision().calibration)) {
    delay_.shift(change->delay_s(), change->after().delay_sigma_s);
  }
  if (!trusted_frame_) return;
  motion_.correct(past.at(*trusted_frame_));
  T_bridge_ = past.at(past.revision().path.back().frame);
}

TrackResult SpectralTracker::tracked(const alignment::Alignment& alignment) const {
  TrackResult result;
  result.T_odom_camera = (T_world_local_ * alignment.T_local_camera).normalized();
  result.status =
      aligner_.observability().mask != 0 ? TrackingStatus::kDegenerate : TrackingStatus::kOk;
  result.information = alignment.information();
  result.diagnostics = describe(aligner_, alignment);
  result.diagnostics.readout_s = readout_.readout_s();
  return result;
}

TrackResult SpectralTracker::lost(const alignment::Alignment& alignment, double timestamp_s) {
  if (motion_.frames_held() == 0) {
    lost_since_s_ = timestamp_s;
    T_bridge_ = motion_.pose();
  }
  motion_.miss();
  policy_.lost();
  const SE3 T_carried_on = motion_.predict(timestamp_s);
  if (T_carried_on.all_finite() &&
      (timestamp_s - lost_since_s_ <= config_.aligner.alignment.bridge_s ||
       motion_.frames_held() == 1)) {
    T_bridge_ = T_carried_on;
  }
  // Surfaces that were not believed are still the best guess of how the camera went on.
  if (alignment.lost_reason == alignment::LostReason::kPoorPictureFit &&
      evidence_of(alignment).explained_by_surfaces &&
      motion_.judge(alignment.T_local_camera) == alignment::LostReason::kNone) {
    T_bridge_ = alignment.T_local_camera;
  }
  TrackResult result;
  result.status = TrackingStatus::kLost;
  result.lost_reason = alignment.lost_reason;
  result.T_odom_camera = (T_world_local_ * T_bridge_).normalized();
  result.diagnostics = describe(aligner_, alignment);
  return result;
}

}  // namespace sgs::tracker
