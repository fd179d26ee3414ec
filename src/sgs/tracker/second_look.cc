// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/tracker/second_look.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "sgs/alignment/joint_aligner.h"
#include "sgs/camera/movers.h"
#include "sgs/tracker/motion_model.h"

namespace sgs::tracker {
namespace {

constexpr double kFilm_s = 1, kEvery_s = 0.5;
constexpr std::size_t kFewest = 5;  // frames

// How the frame that is played backwards was measured: the camera's own motion is that of true
// time, whichever way the film runs.
alignment::ReadoutModel readout_model(const MotionModel& motion, double t,
                                      const registration::FrameMotion& forwards, double readout_s) {
  return {[&motion, t, readout_s](const SE3& T) {
            const registration::FrameMotion known{-readout_s * motion.rate_to(T, t)};
            return alignment::known_readout(known).belief(T);
          },
          [&motion, t, forwards](const Vector6d& readout, const SE3& T) {
            const Vector6d velocity =
                -(forwards.depth_delay_s > 0 ? motion.rate_to(T, t) : motion.steady_rate());
            return registration::FrameMotion{readout, velocity, forwards.depth_delay_s,
                                             forwards.learned_delay_s};
          }};
}

double cost_of(const alignment::Alignment& a) { return a.picture ? a.picture->mean_cost : 0; }

// From the prediction; from the last pose, too, where the picture fits much worse than usual.
alignment::Alignment follow(const MotionModel& motion, const alignment::ReadoutModel& readout,
                            double t, double usual_cost, alignment::JointAligner& aligner) {
  constexpr double kBadly = 1.4;
  alignment::Alignment a = aligner.align(motion.predict(t), readout);
  if (a.trusted() && !(usual_cost > 0 && cost_of(a) > kBadly * usual_cost)) return a;
  alignment::Alignment again = aligner.align(motion.pose(), readout);
  const bool better = again.trusted() && cost_of(again) < cost_of(a);
  return !a.trusted() || better ? again : a;
}

// A turn counts at an arm's length.
double length_of(const SE3& motion) { return motion.log().norm(); }

// By how much the motion from one frame to the next differs from the one before it, at most.
double largest_jump(const std::vector<SE3>& poses) {
  double out = 0;
  for (std::size_t i = 2; i < poses.size(); ++i) {
    const SE3 before = poses[i - 2].inverse() * poses[i - 1];
    out = std::max(out, length_of(before.inverse() * (poses[i - 1].inverse() * poses[i])));
  }
  return out;
}

// A camera that was dragged along has jumped back, and as far as it was dragged. Where nothing has
// jumped so far, it is the look back that went along with somebody.
bool is_believed(const std::vector<SE3>& before, const std::vector<SE3>& after) {
  constexpr double kSmoother = 0.7, kExplained = 2;
  const double jump = largest_jump(before);
  double farthest = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    farthest = std::max(farthest, length_of(before[i].inverse() * after[i]));
  }
  return largest_jump(after) < kSmoother * jump && farthest < kExplained * jump;
}

}  // namespace

void SecondLook::see(const std::shared_ptr<const RgbdFrame>& frame, const TrackResult& result) {
  const double now = frame->timestamp_s;
  if (film_.empty() || now <= film_.back().frame->timestamp_s) {
    film_.clear();
    looked_s_ = now;
    moves_ = false;
  }
  film_.push_back({frame, result.motion, result.still});
  while (now - film_.front().frame->timestamp_s > kFilm_s) film_.pop_front();
  moves_ = moves_ || result.still;
  const double readout_s = result.diagnostics.readout_s;
  if (std::isfinite(readout_s)) readout_s_ = readout_s;
}

std::optional<PoseCorrection> SecondLook::look_back(const history::Path& path) {
  if (film_.empty()) return {};
  const double now = film_.back().frame->timestamp_s;
  if (!moves_ || film_.size() < kFewest || now - looked_s_ < kEvery_s) return {};
  looked_s_ = now;
  moves_ = false;
  const auto seen = play_backwards();
  if (!seen) return {};
  // The first of them stays where it is.
  const SE3 T_world_last = path.at(film_.front().frame->index) * seen->front().inverse();
  std::vector<SE3> before, after;
  std::vector<double> times_s;
  for (std::size_t i = 0; i < film_.size(); ++i) {
    times_s.push_back(film_[i].frame->timestamp_s);
    before.push_back(path.at(film_[i].frame->index));
    after.push_back((T_world_last * (*seen)[i]).normalized());
  }
  if (!is_believed(before, after)) return {};
  std::vector<MovedPose> moved;
  for (std::size_t i = 0; i < film_.size(); ++i) moved.push_back({times_s[i], before[i], after[i]});
  return PoseCorrection(std::move(moved));
}

// Each frame's camera to the last one's; empty where they cannot be told.
std::optional<std::vector<SE3>> SecondLook::play_backwards() const {
  alignment::JointAligner aligner(config_.aligner, film_.back().frame->camera, SE3{});
  MotionModel motion(config_.motion, SE3{});
  history::Revision revision;
  std::vector<SE3> poses(film_.size());
  constexpr double kShare = 0.2;
  double usual_cost = 0;
  for (std::size_t k = film_.size(); k-- > 0;) {
    const Seen& seen = film_[k];
    RgbdFrame frame = *seen.frame;
    frame.index = -frame.index;
    frame.timestamp_s = -frame.timestamp_s;
    const double t = frame.timestamp_s;
    if (k + 1 == film_.size()) {
      frame.still = in_both(frame.still, seen.still);
      aligner.look_at(frame, revision, nullptr);
      aligner.begin(SE3{}, seen.motion);
    } else {
      aligner.look_at(frame, revision, nullptr);
      const alignment::Alignment a =
          follow(motion, readout_model(motion, t, seen.motion, readout_s_), t, usual_cost, aligner);
      if (!a.trusted() || motion.judge(a.T_local_camera) != alignment::LostReason::kNone) return {};
      usual_cost = usual_cost > 0 ? usual_cost + kShare * (cost_of(a) - usual_cost) : cost_of(a);
      if (a.picture_holds()) aligner.learn_noise(a);
      aligner.remember(a);
      aligner.extend(a, a.points_motion.readout);
      poses[k] = a.T_local_camera;
    }
    motion.accept(poses[k], t);
    revision.path.append({frame.index, t, poses[k]});
  }
  return poses;
}

}  // namespace sgs::tracker
