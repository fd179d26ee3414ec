// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/alignment/terms/visual_term.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "sgs/registration/view_distance.h"

namespace sgs::alignment {
namespace {

constexpr double kDefaultDepth_m = 2;
// A keyframe that fits worse than the newest one by this factor for so many frames contradicts it.
constexpr double kFarWorse = 2.5;
constexpr int kContradictions = 5;
// Coarser levels have too few pixels for three more unknowns: the readout is as believed there.
constexpr int kCoarsestReadoutLevel = 1;
// Share of the limits within which a camera has hardly moved, and how much less it may see then.
constexpr double kHardlyMoved = 0.3, kLeastShare = 0.4;
// Of fewer pixels no width of a distribution is known.
constexpr int kEnoughPixels = 100;

}  // namespace

void VisualTerm::set_frame(const RgbdFrame& frame, const LocalPast& past) {
  if (past.revision().number() != past_.revision().number()) {
    for (Keyframe& k : keyframes_) k.contradictions = 0;
  }
  past_ = past;
  pyramid_.build(frame.color, frame.camera, config_.photometric.levels, frame.seen.get());
  levels_ = pyramid_.levels();
  noise_.resize(static_cast<std::size_t>(levels_), 1.0);
  frame_ = &frame;
}

double VisualTerm::view_distance(const Keyframe& keyframe, const SE3& T_local_camera) const {
  return registration::view_distance(pyramid_.level(0).camera, keyframe.mean_depth_m,
                                     past_.at(keyframe.frame).inverse() * T_local_camera);
}

VisualTerm::Fit VisualTerm::start(const SE3& T_local_predicted, References references) {
  Fit fit;
  fit.term_ = this;
  if (keyframes_.empty()) return fit;
  const auto add = [&](std::size_t index) {
    place(keyframes_[index]);
    fit.references_.push_back({index, {}, {}});
  };
  add(newest_);
  if (references == References::kNewest) return fit;
  std::vector<std::pair<double, std::size_t>> near;
  for (std::size_t i = 0; i < keyframes_.size(); ++i) {
    const Keyframe& k = keyframes_[i];
    if (i == newest_ || k.drawn || k.contradictions >= kContradictions) continue;
    const double distance = view_distance(keyframes_[i], T_local_predicted);
    if (distance < config_.keyframes.revisit_distance) near.emplace_back(distance, i);
  }
  std::sort(near.begin(), near.end());
  for (const auto& [distance, index] : near) {
    if (static_cast<int>(fit.references_.size()) >= config_.keyframes.max_references) break;
    add(index);
  }
  return fit;
}

std::size_t VisualTerm::nearest_keyframe(const SE3& T_local_camera, bool with_drawings) const {
  std::size_t out = newest_;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < keyframes_.size(); ++i) {
    if (keyframes_[i].drawn && !with_drawings) continue;
    const double distance = view_distance(keyframes_[i], T_local_camera);
    if (distance >= nearest) continue;
    nearest = distance;
    out = i;
  }
  return out;
}

void VisualTerm::compare_references(const Fit& fit) {
  const auto cost = [](const Fit::Reference& r) {
    return r.last.used > 0 ? r.last.cost / r.last.used : 0.0;
  };
  double newest = 0;
  for (const Fit::Reference& r : fit.references_) {
    if (r.keyframe == newest_) newest = cost(r);
  }
  if (newest <= 0) return;
  for (const Fit::Reference& r : fit.references_) {
    if (r.keyframe == newest_) continue;
    int& count = keyframes_[r.keyframe].contradictions;
    count = cost(r) > kFarWorse * newest ? count + 1 : 0;
  }
}

void VisualTerm::leave_out_older(const Fit& fit) {
  for (const Fit::Reference& r : fit.references_) {
    if (r.keyframe != newest_) keyframes_[r.keyframe].contradictions = kContradictions;
  }
}

// Quickly at first, then slowly, and never far for one frame: at a wrong place every picture is
// noisy, and noise that followed would make it a right one.
void VisualTerm::learn_noise(const Fit& fit) {
  if (!config_.photometric.estimate_noise) return;
  constexpr double kLeastShare = 0.01, kLeast = 0.125, kMost = 8;
  constexpr int kSlowly = 10;
  const double share = std::max(kLeastShare, 1.0 / (kSlowly + noise_frames_++));
  for (std::size_t l = 0; l < fit.squares_.size(); ++l) {
    if (!(fit.squares_[l] > 0)) continue;
    const double step = std::clamp(fit.squares_[l] - 1, -1.0, 1.0);
    noise_[l] = std::clamp(noise_[l] * std::exp(0.5 * share * step), kLeast, kMost);
  }
}

void VisualTerm::Fit::set_readout(const ReadoutEstimator::Belief& belief) {
  belief_ = belief;
  readout_ = belief.mean;
}

degeneracy::NormalEquations VisualTerm::Fit::linearize(int level, const SE3& T_local_camera) {
  SGS_CHECK(has_references(), "nothing to align to");
  sum_ = {};
  const registration::ReadoutMotion readout(readout_);
  readout_free_ = level <= kCoarsestReadoutLevel;
  const auto at = static_cast<std::size_t>(level);
  for (Reference& r : references_) {
    const auto& reference = term_->keyframes_[r.keyframe].reference;
    if (level >= reference.levels()) continue;
    r.last = registration::linearize(reference, level, term_->pyramid_, term_->frame_->depth,
                                     T_local_camera, r.brightness, term_->config_.photometric,
                                     readout, readout_free_, term_->noise_[at],
                                     moving_.any() ? &moving_ : nullptr);
    sum_.H += r.last.H;
    sum_.b += r.last.b;
    sum_.H_pose_readout += r.last.H_pose_readout;
    sum_.H_readout += r.last.H_readout;
    sum_.b_readout += r.last.b_readout;
    sum_.cost += r.last.cost;
    sum_.square_sum += r.last.square_sum;
    sum_.used += r.last.used;
    if (r.keyframe == term_->newest_) {
      const auto points = static_cast<int>(reference.points(level).size());
      newest_share_ =
          static_cast<double>(r.last.used) / static_cast<double>(std::max(1, points - r.last.gone));
    }
  }
  squares_.resize(std::max(squares_.size(), at + 1), 0);
  squares_[at] = sum_.used >= kEnoughPixels ? sum_.square_sum / sum_.used : 0;
  if (!readout_free_) return {sum_.H, sum_.b, sum_.cost};
  const Eigen::Vector3d off = (readout_ - belief_.mean).head<3>();
  const Eigen::Vector3d b_readout = sum_.b_readout + belief_.information * off;
  const Eigen::Matrix3d H_readout = sum_.H_readout + belief_.information;
  const Eigen::Matrix<double, 6, 3> G = sum_.H_pose_readout * H_readout.inverse();
  return {sum_.H - G * sum_.H_pose_readout.transpose(), sum_.b - G * b_readout,
          sum_.cost + 0.5 * off.dot(belief_.information * off)};
}

void VisualTerm::Fit::back_substitute(const Vector6d& xi) {
  Eigen::Vector3d step = Eigen::Vector3d::Zero();
  if (readout_free_) {
    const Eigen::Matrix3d H_readout = sum_.H_readout + belief_.information;
    const Eigen::Vector3d off = (readout_ - belief_.mean).head<3>();
    const Eigen::Vector3d b = sum_.b_readout + belief_.information * off;
    step = -(H_readout.inverse() * (b + sum_.H_pose_readout.transpose() * xi));
    readout_.head<3>() += step;
  }
  for (Reference& r : references_) r.brightness = r.last.updated(r.brightness, xi, step);
}

VisualTerm::Fit::ReadoutMeasurement VisualTerm::Fit::measured_readout(
    const Matrix6d& H_others) const {
  const auto pose = (sum_.H + H_others).ldlt();
  const Eigen::Matrix<double, 6, 3> G = pose.solve(sum_.H_pose_readout);
  ReadoutMeasurement out;
  out.information = sum_.H_readout - sum_.H_pose_readout.transpose() * G;
  out.information = (0.5 * (out.information + out.information.transpose())).eval();
  // At the optimum the belief's pull balances the picture's.
  out.rotation = readout_.head<3>() - out.information.inverse() * sum_.b_readout;
  return out;
}

// Within `share` of the limits that make a new keyframe.
bool VisualTerm::is_near(const Keyframe& keyframe, const SE3& T_local_camera, double share) const {
  const SE3 T = past_.at(keyframe.frame).inverse() * T_local_camera;
  return T.t.norm() < share * config_.keyframes.keyframe_translation * keyframe.mean_depth_m &&
         T.angle() < share * config_.keyframes.keyframe_rotation_deg * std::numbers::pi / 180;
}

bool VisualTerm::wants_keyframe(const SE3& T_local_camera, const Fit& fit) const {
  if (keyframes_.empty() || keyframes_[newest_].drawn) return true;
  if (!is_near(keyframes_[newest_], T_local_camera, 1.0)) return true;
  // A camera that has hardly moved sees less of its keyframe only where something has come before
  // it: another keyframe would see no more, and start from this one's errors.
  const bool stands =
      config_.keyframes.patient && is_near(keyframes_[newest_], T_local_camera, kHardlyMoved);
  return fit.newest_share_ < (stands ? kLeastShare : 1.0) * config_.keyframes.keyframe_visible;
}

void VisualTerm::insert_keyframe(const SE3& T_local_camera, const Fit& fit, const Vector6d& readout,
                                 const registration::FrameMotion& motion,
                                 const registration::SurfaceLookup& surface) {
  constexpr double kSameView = 0.8;
  for (const Fit::Reference& r : fit.references_) {
    if (r.keyframe == newest_ || !is_near(keyframes_[r.keyframe], T_local_camera, kSameView))
      continue;
    const auto points = keyframes_[r.keyframe].reference.points(0).size();
    if (r.last.used < config_.keyframes.keyframe_visible * static_cast<double>(points)) continue;
    newest_ = r.keyframe;
    return;
  }
  const double depth_m = registration::mean_depth(frame_->depth, config_.photometric.max_depth_m);
  keyframes_.push_back({frame_->index,
                        registration::PhotometricReference(pyramid_, frame_->depth, T_local_camera,
                                                           config_.photometric, surface,
                                                           registration::ReadoutMotion(readout)),
                        past_.revision().calibration, depth_m > 0 ? depth_m : kDefaultDepth_m,
                        motion});
  newest_ = keyframes_.size() - 1;
}

void VisualTerm::insert_drawing(const SE3& T_local_camera,
                                const registration::SurfaceLookup& surface) {
  insert_keyframe(T_local_camera, {}, Vector6d::Zero(), {}, surface);
  keyframes_[newest_].drawn = true;
}

bool VisualTerm::Fit::to_drawing() const {
  return has_references() && term_->keyframes_[references_.front().keyframe].drawn;
}

int VisualTerm::Fit::finest_level() const { return to_drawing() && term_->levels_ > 1 ? 1 : 0; }

// Where and as it is believed to be now.
void VisualTerm::place(Keyframe& keyframe) const {
  keyframe.reference.set_pose(past_.at(keyframe.frame));
  const history::CalibrationPtr& now = past_.revision().calibration;
  if (const auto change = history::depth_change(keyframe.calibration, now)) {
    keyframe.reference.change_depth(*change, keyframe.motion.recalibrate(change->delay_s()));
    keyframe.calibration = now;
  }
}

}  // namespace sgs::alignment
