// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/degeneracy/observability.h"
#include "sgs/tracker/geometric_term.h"
#include "sgs/tracker/motion_model.h"
#include "sgs/tracker/readout_estimator.h"
#include "sgs/tracker/relocaliser.h"
#include "sgs/tracker/tracker.h"
#include "sgs/tracker/visual_term.h"

namespace sgs::tracker {

/// The `default` tracker: geometry and photometry in one Gauss-Newton, coarse to fine, with
/// geometry projected off the axes that the frame's own surfaces do not observe:
///     H = w_g K^T H_g K + H_v + damping I,   b = w_g K^T b_g + b_v,   K = I - P
/// (docs/method.md, section 6; `fusion = joint` leaves K = I). A frame is lost when an axis is
/// observed by neither, when the alignment does not explain the picture or when it would jump; then
/// the pose is carried on at constant velocity for a moment, held after that, and searched for
/// among the keyframes.
class SpectralTracker : public Tracker {
 public:
  SpectralTracker(const TrackerConfig& config, const PinholeCamera& camera,
                  const SE3& T_world_first);

  TrackResult track(const RgbdFrame& frame, const map::SnapshotPtr& snapshot) override;
  bool follows_map() const override { return geometry_.targets().follows_map(); }

 private:
  struct Outcome {
    SE3 T_map_camera;
    bool trusted = false;
  };
  void observe_geometry(Diagnostics& d);
  Outcome align(const SE3& T_start, double timestamp_s, Diagnostics& d);
  bool fits_badly(const Diagnostics& d) const;
  Outcome align_again(const Outcome& first, double timestamp_s, Diagnostics& d);
  void align_level(int level, bool use_geometry, SE3& T, Diagnostics& d);
  bool explains_frame(const SE3& T, bool use_geometry, Diagnostics& d);
  Vector6d frame_readout() const;
  void learn_readout(const SE3& T, double timestamp_s, const Diagnostics& d);
  Outcome recover(const RgbdFrame& frame, Diagnostics& d);
  bool extend_map(const RgbdFrame& frame, const SE3& T, const Diagnostics& d);
  TrackResult lost(double timestamp_s, const Diagnostics& d);

  TrackerConfig config_;
  bool remove_;  // fusion = remove
  SE3 T_world_map_;
  GeometricTerm geometry_;
  VisualTerm vision_;
  Relocaliser relocaliser_;
  MotionModel motion_;  // camera to map
  ReadoutEstimator readout_;
  degeneracy::HysteresisState hysteresis_;
  degeneracy::SurfaceInformation surfaces_;
  degeneracy::Observability observability_;
  Matrix6d H_geometry_ = Matrix6d::Zero();  // of the last pose checked, as it was weighted
  double usual_visual_cost_ = 0;            // mean cost per pixel of the last frames
  double lost_since_s_ = 0;
  int lost_frames_ = 0;
  SE3 T_bridge_;  // camera to map while lost
};

}  // namespace sgs::tracker
