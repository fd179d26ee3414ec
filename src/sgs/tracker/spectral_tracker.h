// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "sgs/degeneracy/observability.h"
#include "sgs/degeneracy/spectrum.h"
#include "sgs/tracker/motion_model.h"
#include "sgs/tracker/readout_estimator.h"
#include "sgs/tracker/relocaliser.h"
#include "sgs/tracker/step_times.h"
#include "sgs/tracker/terms/geometric_term.h"
#include "sgs/tracker/terms/visual_term.h"
#include "sgs/tracker/tracker.h"

namespace sgs::tracker {

/// What one alignment of a frame came to: a pose, what it rests on, and why it is not to be trusted
/// if it is not.
struct Alignment {
  /// Geometry at the pose.
  struct Geometry {
    int inliers = 0;
    double cost = 0;
    double overlap = 0;
    degeneracy::Spectrum spectrum;  ///< of the registration alone
    Matrix6d H = Matrix6d::Zero();  ///< as it enters the joint equations
    bool holds = false;             ///< enough points are matched
  };
  /// The picture at the pose.
  struct Picture {
    int pixels = 0;
    double mean_cost = 0;
    bool holds = false;             ///< enough pixels fit well enough
    Matrix6d H = Matrix6d::Zero();  ///< normal equations
  };

  SE3 T_local_camera;
  LostReason lost_reason = LostReason::kNone;
  std::optional<Geometry> geometry;  ///< empty: there was nothing to register
  std::optional<Picture> picture;    ///< empty: there was no keyframe to align to
  VisualTerm::Fit fit;
  Vector6d points_readout = Vector6d::Zero();  ///< camera twist that the points are corrected for
  int iterations = 0;                          ///< Gauss-Newton steps over all levels

  bool trusted() const { return lost_reason == LostReason::kNone; }
  bool picture_holds() const { return picture && picture->holds; }
};

/// The `default` tracker: geometry and photometry in one Gauss-Newton, coarse to fine, with
/// geometry projected off the axes that the frame's own surfaces do not observe:
///     H = w_g K^T H_g K + H_v + damping I,   b = w_g K^T b_g + b_v,   K = I - P
/// (docs/method.md, section 6; `fusion = joint` leaves K = I). A frame is lost when an axis is
/// observed by neither, when the alignment does not explain the picture or when it would jump
/// (LostReason); then the pose is carried on at constant velocity for a moment, held after that,
/// and searched for among the keyframes.
class SpectralTracker : public Tracker {
 public:
  SpectralTracker(const SpectralConfig& config, const PinholeCamera& camera,
                  const SE3& T_world_first);

  TrackResult track(const RgbdFrame& frame, const map::SnapshotPtr& snapshot) override;
  bool follows_map() const override { return geometry_.targets().follows_map(); }

 private:
  // The steps of a frame.
  void look_at(const RgbdFrame& frame, const map::SnapshotPtr& snapshot);
  Alignment start_map() const;
  Alignment follow_camera(double timestamp_s);
  Alignment find_camera(const RgbdFrame& frame);
  void learn_from(const Alignment& alignment, double timestamp_s);
  bool extend_map(const RgbdFrame& frame, const Alignment& alignment);
  TrackResult tracked(const Alignment& alignment, bool keyframe) const;
  TrackResult lost(const Alignment& alignment, double timestamp_s);
  Diagnostics describe(const Alignment& alignment) const;

  // An alignment. While it lasts, geometry_ holds its points and matches; what outlives it is the
  // value alone.
  Alignment align(const SE3& T_start, double timestamp_s, const MotionModel& motion);
  void align_level(int level, bool with_geometry, Alignment& a);
  degeneracy::NormalEquations linearize_geometry(int level, const SE3& T);
  Alignment::Geometry geometry_at(const SE3& T);
  Alignment::Picture picture_at(const SE3& T, VisualTerm::Fit& fit);
  LostReason judge(const Alignment& a, const MotionModel& motion) const;
  LostReason why_unseen(const Alignment& a) const;
  bool fits_badly(const Alignment& a) const;
  Vector6d frame_readout(const VisualTerm::Fit& fit) const;

  bool enough_points() const;
  int source_points() const { return static_cast<int>(geometry_.source().points.size()); }

  SpectralConfig config_;
  SE3 T_world_local_;
  GeometricTerm geometry_;
  VisualTerm vision_;
  Relocaliser relocaliser_;
  MotionModel motion_;  // camera to local
  ReadoutEstimator readout_;
  double usual_visual_cost_ = 0;  // mean cost per pixel of the last frames
  double lost_since_s_ = 0;
  SE3 T_bridge_;  // camera to local while lost

  // Of the current frame, before anything is matched:
  degeneracy::HysteresisState hysteresis_;
  degeneracy::SurfaceInformation surfaces_;
  degeneracy::Observability observability_;
  double planarity_ = Diagnostics::kNone;
  StepTimes times_;
};

}  // namespace sgs::tracker
