// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "sgs/alignment/joint_aligner.h"
#include "sgs/alignment/known_view.h"
#include "sgs/alignment/readout_estimator.h"
#include "sgs/tracker/delay_estimator.h"
#include "sgs/tracker/loss_policy.h"
#include "sgs/tracker/motion_model.h"
#include "sgs/tracker/relocaliser.h"
#include "sgs/tracker/tracker.h"

namespace sgs::tracker {

/// The `default` tracker: one JointAligner (geometry and photometry in one Gauss-Newton) with a
/// policy. A frame is lost when an axis is observed by neither, when the alignment does not explain
/// the picture or when it would jump (LostReason); then the pose is carried on at constant velocity
/// for a moment, held after that, and searched for among the keyframes.
class SpectralTracker : public Tracker {
 public:
  SpectralTracker(const SpectralConfig& config, const PinholeCamera& camera,
                  const SE3& T_world_first);

  TrackResult track(const RgbdFrame& frame, const history::Revision& revision,
                    const map::SnapshotPtr& snapshot) override;
  bool follows_map() const override { return aligner_.geometry().targets().follows_map(); }
  bool knows_depth_lag() const override { return true; }
  void remember_in(const std::shared_ptr<history::ViewStore>& views) override {
    relocaliser_.remember_in(views);
  }
  bool finds_itself() const override { return true; }
  void know(const alignment::KnownView& view, const history::Revision& revision) override;
  const PlaceSearch* place_search() const override { return search_ ? &*search_ : nullptr; }

 private:
  // The steps of a frame.
  void follow(const history::CalibrationPtr& before);
  alignment::Alignment start_map() const;
  alignment::Alignment follow_camera(double timestamp_s);
  alignment::Alignment without_contradictions(const alignment::Alignment& a, double timestamp_s);
  alignment::Alignment follow_unless_elsewhere(const RgbdFrame& frame);
  alignment::Alignment find_camera(const RgbdFrame& frame);
  alignment::Alignment look_for_place(const RgbdFrame& frame);
  std::optional<alignment::Alignment> relocalised(
      const RgbdFrame& frame, const std::function<bool(const alignment::Alignment&)>& is_believed);
  void learn_from(const alignment::Alignment& alignment, const Vector6d& rate);
  bool extend_map(const RgbdFrame& frame, const std::shared_ptr<const PixelMask>& still,
                  const alignment::Alignment& alignment, const Vector6d& readout,
                  const Vector6d& rate);
  TrackResult tracked(const alignment::Alignment& alignment) const;
  TrackResult lost(const alignment::Alignment& alignment, double timestamp_s);

  alignment::Alignment align(
      const SE3& T_start, double timestamp_s, const MotionModel& motion,
      alignment::JointAligner::From from = alignment::JointAligner::From::kNear);
  alignment::Alignment align_picture(const SE3& T_start, double timestamp_s);
  std::optional<alignment::Alignment> picture_of_this_place(const alignment::Alignment& a,
                                                            double timestamp_s);
  alignment::ReadoutModel readout_model(double timestamp_s, const MotionModel& motion) const;
  bool fits_badly(const alignment::Alignment& a) const;
  Evidence evidence_of(const alignment::Alignment& a) const;
  bool is_in_map() const { return !search_ || search_->found; }
  bool is_found(const alignment::Alignment& a) const { return policy_.is_found(evidence_of(a)); }
  bool is_first_place(const alignment::Alignment& a, double timestamp_s);
  void note_look(double timestamp_s);
  Vector6d frame_readout(const Vector6d& readout) const;

  SpectralConfig config_;
  PinholeCamera camera_;
  SE3 T_world_local_;
  alignment::JointAligner aligner_;
  Relocaliser relocaliser_;
  LossPolicy policy_;
  MotionModel motion_;                         // camera to local
  std::optional<std::int64_t> trusted_frame_;  // index of the last one that was not lost
  alignment::ReadoutEstimator readout_;
  DelayEstimator delay_;
  double depth_delay_s_ = 0;  // of the frame that is tracked, with what was learned of it
  double lost_since_s_ = 0;
  SE3 T_bridge_;  // camera to local while lost

  std::optional<PlaceSearch> search_;  // in the map that the tracker was given, if it was
  std::vector<double> view_times_s_;   // of that map's views, in their sessions
  /// Where a frame saw itself in that map before the camera was found there.
  struct Sighting {
    SE3 T_local_camera;
    double timestamp_s;
  };
  std::optional<Sighting> sighting_;
};

}  // namespace sgs::tracker
