// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "sgs/alignment/alignment_config.h"
#include "sgs/alignment/local_past.h"
#include "sgs/alignment/readout_estimator.h"
#include "sgs/camera/pyramid.h"
#include "sgs/camera/rgbd_frame.h"
#include "sgs/degeneracy/fusion.h"
#include "sgs/registration/photometric.h"

namespace sgs::alignment {

/// The photometric half of tracking, without a policy of its own: the current frame's pyramid and
/// the keyframes it can be aligned to. Poses are camera to the tracker's local frame.
///
/// References are the last keyframe and, when the camera looks again at a place it has left, the
/// older keyframe that saw it best: that one carries no drift of the way in between.
class VisualTerm {
 public:
  explicit VisualTerm(const VisionConfig& config) : config_(config) {}

  /// Builds the pyramid of a frame; keeps a reference to its depth, which must outlive its use.
  /// `past` tells where the keyframes so far are; what is known better of their depth reaches each
  /// when it is next aligned to: a frame that all of them waited for would be late.
  void set_frame(const RgbdFrame& frame, const LocalPast& past);
  int levels() const { return levels_; }

  class Fit;
  enum class References { kNewestAndOlder, kNewest };
  /// The fit of a frame expected at `T_local_predicted`, to the keyframes chosen for that pose.
  Fit start(const SE3& T_local_predicted, References references = References::kNewestAndOlder);

  /// Learns from an accepted fit which keyframes contradict the newest one: one that has for some
  /// frames fitted far worse lies elsewhere, since the camera has drifted on its way back to it.
  /// It is left out until the next revision.
  void compare_references(const Fit& fit);
  /// A frame that has fitted the newest keyframe alone did not fit it together with the older ones
  /// of this fit: they contradict it.
  void leave_out_older(const Fit& fit);
  /// Learns from an accepted fit how wide residuals are at each level.
  void learn_noise(const Fit& fit);
  /// Whether the frame, fitted at `T_local_camera`, is far enough from the newest keyframe to
  /// become one.
  bool wants_keyframe(const SE3& T_local_camera, const Fit& fit) const;
  /// Makes the current frame a keyframe, unless an old one that sees the same takes its place.
  /// `readout`: camera twist over its readout, `motion`: that its surfaces are corrected for.
  void insert_keyframe(const SE3& T_local_camera, const Fit& fit, const Vector6d& readout,
                       const registration::FrameMotion& motion,
                       const registration::SurfaceLookup& surface);
  /// Makes a drawing of the map a keyframe, for who is carried to it; what it shows is softer than
  /// what a camera sees, so that the frame which is aligned to it takes its place.
  void insert_drawing(const SE3& T_local_camera, const registration::SurfaceLookup& surface);
  int keyframes() const { return static_cast<int>(keyframes_.size()); }
  /// Number of the keyframe the camera was last at.
  std::size_t newest_keyframe() const { return newest_; }
  /// Number of the keyframe that saw most nearly what a camera at this pose would see, whether or
  /// not it contradicts those that the camera was at lately. Drawings count only where they are
  /// asked for: who was found by a picture is aligned to pictures.
  std::size_t nearest_keyframe(const SE3& T_local_camera, bool with_drawings = false) const;
  /// The camera was carried off, to where one of the keyframes is: what it may still see of the one
  /// that it was at (down a corridor, much), it sees from too far away to be aligned to.
  void carry_to(std::size_t keyframe) { newest_ = keyframe; }

 private:
  struct Keyframe {
    std::int64_t frame;                            // its index
    registration::PhotometricReference reference;  // placed and calibrated where it is aligned to
    history::CalibrationPtr calibration;           // of its depth
    double mean_depth_m;
    registration::FrameMotion motion;  // that its surfaces are corrected for
    bool drawn = false;
    int contradictions = 0;  // frames in a row that fitted it far worse than the newest one
  };
  void place(Keyframe& keyframe) const;
  double view_distance(const Keyframe& keyframe, const SE3& T_local_camera) const;
  bool is_near(const Keyframe& keyframe, const SE3& T_local_camera, double share) const;

  VisionConfig config_;
  LocalPast past_;
  std::vector<double> noise_;  // of each level, in units of config_.photometric.sigma_at()
  int noise_frames_ = 0;       // that it was learned from
  GrayPyramid pyramid_;
  const RgbdFrame* frame_ = nullptr;
  int levels_ = 0;
  std::vector<Keyframe> keyframes_;
  std::size_t newest_ = 0;  // the keyframe the camera was last at: not always the last made
};

/// One alignment of the current frame to its references, as far as it has come: their summed normal
/// equations, and what those leave out of the pose (each reference's gain and offset, the turn of
/// the camera during the readout). A value, good until the term gets a new frame or keyframe.
class VisualTerm::Fit {
 public:
  /// A fit to nothing.
  Fit() = default;

  bool has_references() const { return !references_.empty(); }
  int references() const { return static_cast<int>(references_.size()); }
  /// What is believed of the camera's motion during the readout of the frame; the estimate starts
  /// there.
  void set_readout(const ReadoutEstimator::Belief& belief);
  /// The same once the pose is known better: the estimate stays.
  void update_belief(const ReadoutEstimator::Belief& belief) { belief_ = belief; }

  /// Pixels there do not count from now on.
  void set_moving(const registration::CellMask& moving) { moving_ = moving; }
  /// Normal equations of all references at a level, gains, offsets and the readout's rotation
  /// eliminated; needs references.
  degeneracy::NormalEquations linearize(int level, const SE3& T_local_camera);
  /// Back-substitutes what linearize() eliminated after the pose has moved by `xi`.
  void back_substitute(const Vector6d& xi);
  /// Camera twist over the readout of the frame, as it appears against the newest keyframe.
  const Vector6d& readout() const { return readout_; }
  /// The rotation over the readout that the last linearize() sees without any belief about it,
  /// with its information; `H_others` is what other terms know of the pose.
  struct ReadoutMeasurement {
    Eigen::Vector3d rotation;
    Eigen::Matrix3d information;
  };
  ReadoutMeasurement measured_readout(const Matrix6d& H_others) const;

  /// Whether the newest keyframe is a drawing of the map.
  bool to_drawing() const;
  /// The finest level that is worth aligning: drawings are soft.
  int finest_level() const;
  /// Of the last linearize(): pixels used, and mean cost per pixel.
  int used() const { return sum_.used; }
  double mean_cost() const { return sum_.used > 0 ? sum_.cost / sum_.used : 0.0; }
  /// Share of the newest keyframe's pixels that were used, without those lost to what moves.
  double newest_share() const { return newest_share_; }

 private:
  friend class VisualTerm;
  struct Reference {
    std::size_t keyframe;
    registration::AffineBrightness brightness;
    registration::PhotometricLinearization last;
  };

  const VisualTerm* term_ = nullptr;
  registration::CellMask moving_;  // of the frame
  std::vector<Reference> references_;
  ReadoutEstimator::Belief belief_;
  Vector6d readout_ = Vector6d::Zero();
  bool readout_free_ = false;                   // at the level of the last linearize()
  std::vector<double> squares_;                 // of each level's last linearize(), per pixel
  registration::PhotometricLinearization sum_;  // over references; the readout not eliminated
  double newest_share_ = 0;                     // of the newest keyframe's pixels that were used
};

}  // namespace sgs::alignment
