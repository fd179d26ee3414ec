// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <limits>
#include <optional>

#include "sgs/alignment/expected_motion.h"
#include "sgs/alignment/lost_reason.h"
#include "sgs/alignment/movers/moving_parts.h"
#include "sgs/alignment/step_times.h"
#include "sgs/alignment/terms/geometric_term.h"
#include "sgs/alignment/terms/visual_term.h"
#include "sgs/degeneracy/observability.h"
#include "sgs/degeneracy/spectrum.h"

namespace sgs::alignment {

/// What one alignment of a frame came to: a pose, what it rests on, and why it is not to be trusted
/// if it is not.
struct Alignment {
  /// Geometry at the pose.
  struct Geometry {
    int inliers = 0;
    double cost = 0;
    double overlap = 0;
    double movers = 0;              ///< share of the points that move (MoversConfig)
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
    Vector6d b = Vector6d::Zero();
  };

  SE3 T_local_camera;
  LostReason lost_reason = LostReason::kNone;
  std::optional<Geometry> geometry;  ///< empty: there was nothing to register
  std::optional<Picture> picture;    ///< empty: there was no keyframe to align to
  VisualTerm::Fit fit;
  MovingParts::Judgement moving;            ///< what was left out
  registration::FrameMotion points_motion;  ///< that the points are corrected for
  int iterations = 0;                       ///< Gauss-Newton steps over all levels

  /// Normal equations of what holds, on twists of the camera.
  Matrix6d information() const;
  bool trusted() const { return lost_reason == LostReason::kNone; }
  bool picture_holds() const { return picture && picture->holds; }
};

/// What is believed of the camera's motion while the frame that is aligned was measured.
struct ReadoutModel {
  /// Before its picture is asked, at a pose (camera to local).
  std::function<ReadoutEstimator::Belief(const SE3& T_local_camera)> belief;
  /// The frame's own motion, where that readout appears against the newest keyframe.
  std::function<registration::FrameMotion(const Vector6d& readout, const SE3& T_local_camera)>
      of_frame;
};

/// Of a view whose motion was found when it was tracked: it is not asked again.
ReadoutModel known_readout(const registration::FrameMotion& motion);

/// Geometry and photometry in one Gauss-Newton, coarse to fine, with geometry projected off the
/// axes that the frame's own surfaces do not observe:
///     H = w_g K^T H_g K + H_v + damping I,   b = w_g K^T b_g + b_v,   K = I - P
/// (docs/method.md, section 6; `fusion = joint` leaves K = I). Knows nothing of motion: it aligns
/// the frame it looks at to the targets and keyframes it was given. Poses are camera to local.
class JointAligner {
 public:
  JointAligner(const AlignerConfig& config, const PinholeCamera& camera, const SE3& T_local_world);

  /// Samples the frame, which must outlive its use, and tells which axes its own surfaces observe.
  /// Keyframes and targets follow `revision`, whose path has all frames that extend() took in.
  void look_at(const RgbdFrame& frame, const history::Revision& revision,
               const map::SnapshotPtr& snapshot);
  /// Where an alignment starts: where the camera is expected, or where it is looked for. From afar
  /// geometry turns the camera as much as it moves it.
  enum class From { kNear, kAfar };
  /// Coarse to fine from one start pose. Not trusted where an axis is observed by neither half.
  Alignment align(const SE3& T_start, const ReadoutModel& readout, From from = From::kNear) {
    return align(T_start, readout, {.surfaces = can_be_registered()}, from);
  }
  /// The same by the picture alone.
  Alignment align_picture(const SE3& T_start, const ReadoutModel& readout) {
    return align(T_start, readout, {.surfaces = false}, From::kNear);
  }
  /// The same to surfaces and the newest keyframe's picture, without the older ones'.
  Alignment align_to_newest(const SE3& T_start, const ReadoutModel& readout) {
    return align(T_start, readout,
                 {.surfaces = can_be_registered(), .pictures = VisualTerm::References::kNewest},
                 From::kNear);
  }
  /// What geometry and picture say of a pose that something else has found: nothing moves but the
  /// brightness of the picture.
  Alignment measure(const SE3& T, const ReadoutModel& readout);
  /// Pixels of the aligned frame that show nothing that moves; null: all of them.
  std::shared_ptr<const PixelMask> still_pixels(const RgbdFrame& frame, const Alignment& a) const;
  /// Which of the maps took in the frame.
  struct Extension {
    bool keyframe = false;  ///< a new one of the visual term
    bool targets = false;
  };
  /// Learns which keyframes contradict the newest one, and takes the aligned frame in as visual
  /// keyframe and as targets, each where it is wanted. `readout`: camera twist over the readout of
  /// its picture.
  Extension extend(const Alignment& alignment, const Vector6d& readout);

  /// Takes in the frame looked at, the first one, as lying there. What RgbdFrame::still says moves
  /// is taken for what moved lately, too.
  void begin(const SE3& T_local_camera, const registration::FrameMotion& motion);
  /// Takes in the frame looked at, which is a drawing of the map seen from there: as a visual
  /// keyframe alone (VisualTerm::insert_drawing).
  void take_drawing(const SE3& T_local_camera);
  /// What such an alignment has shown to contradict the newest keyframe is left out from now on
  /// (VisualTerm::leave_out_older).
  void leave_out_older(const Alignment& contradicted) { vision_.leave_out_older(contradicted.fit); }
  /// Learns how wide residuals of an accepted alignment's picture are.
  void learn_noise(const Alignment& a) { vision_.learn_noise(a.fit); }
  /// The frame was taken there, as is believed: what moves is told from it for a while.
  void remember(const Alignment& a);

  bool has_map() const { return geometry_.has_targets() || vision_.keyframes() > 0; }
  /// Whether the frame shows enough depth to be registered: kNone or kTooFewPoints.
  LostReason check_frame() const;
  int source_points() const { return static_cast<int>(geometry_.source().points.size()); }
  const GeometricTerm& geometry() const { return geometry_; }
  const VisualTerm& vision() const { return vision_; }
  /// As last looked at.
  const LocalPast& past() const { return past_; }
  /// The camera is now where this keyframe of vision() is (VisualTerm::carry_to).
  void carry_to(std::size_t keyframe) { vision_.carry_to(keyframe); }
  const degeneracy::Observability& observability() const { return observability_; }
  const degeneracy::SurfaceInformation& surfaces() const { return surfaces_; }
  double planarity() const { return planarity_; }
  bool leaves_out_movers() const { return config_.geometry.movers.any() || told_.any(); }
  StepTimes& times() { return times_; }
  const StepTimes& times() const { return times_; }

 private:
  /// What the frame is aligned to.
  struct References {
    bool surfaces = true;
    VisualTerm::References pictures = VisualTerm::References::kNewestAndOlder;
  };
  Alignment align(const SE3& T_start, const ReadoutModel& readout, const References& to, From from);
  Alignment align_without(const registration::CellMask& found, const SE3& T_start,
                          const ReadoutModel& readout, const References& to, From from);
  void observe_surfaces();
  void leave_out(const registration::CellMask& found, VisualTerm::Fit& fit);
  MovingParts::Judgement judge_parts(const SE3& T, const ReadoutModel& readout);
  Alignment start(const SE3& T_start, const ReadoutModel& readout, const References& to);
  void finish(bool with_geometry, Alignment& a);
  // While an alignment lasts, geometry_ holds its points and matches; what outlives it is the value
  // alone.
  void align_level(int level, bool with_geometry, From from, Alignment& a);
  degeneracy::NormalEquations linearize_geometry(int level, const SE3& T);
  Alignment::Geometry geometry_at(const SE3& T);
  Alignment::Picture picture_at(const SE3& T, VisualTerm::Fit& fit);
  bool can_be_registered() const {
    return geometry_.has_targets() && check_frame() == LostReason::kNone;
  }
  registration::InverseDepthPlane still_surface(int u, int v, const Alignment& a) const;
  LostReason judge(const Alignment& a) const;
  LostReason why_unseen(const Alignment& a) const;

  AlignerConfig config_;
  degeneracy::DegeneracyConfig afar_;
  PinholeCamera camera_;
  LocalPast past_;
  GeometricTerm geometry_;
  VisualTerm vision_;
  MovingParts parts_;
  ExpectedMotion expected_;

  // Of the current frame, before anything is matched:
  degeneracy::HysteresisState hysteresis_before_;  // as the last frame left it
  degeneracy::HysteresisState hysteresis_;
  degeneracy::SurfaceInformation surfaces_;
  degeneracy::Observability observability_;
  double planarity_ = std::numeric_limits<double>::quiet_NaN();
  registration::CellMask told_;  // what moves as RgbdFrame::still says
  double told_share_ = 0;        // of its pixels
  StepTimes times_;
};

}  // namespace sgs::alignment
