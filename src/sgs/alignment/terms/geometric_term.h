// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>

#include "sgs/alignment/alignment_config.h"
#include "sgs/alignment/targets/target_map.h"
#include "sgs/alignment/terms/trial.h"
#include "sgs/camera/rgbd_frame.h"
#include "sgs/degeneracy/observability.h"
#include "sgs/registration/cloud_sampler.h"
#include "sgs/registration/correspondence_search.h"
#include "sgs/registration/geometric_cost.h"
#include "sgs/registration/rolling_shutter.h"

namespace sgs::alignment {

/// The geometric half of tracking, without a policy of its own: samples the frame, searches the
/// target map from a predicted pose and gives normal equations at any pose near it. Trackers
/// iterate over it, alone or together with other terms. Poses are camera to local: the local frame
/// is the tracker's first camera, so that nothing depends on where the world's origin lies.
class GeometricTerm {
 public:
  GeometricTerm(const GeometryConfig& config, const PinholeCamera& camera,
                const SE3& T_local_world);

  /// Samples the frame's points; targets follow what is believed of the past, and take over the
  /// newest state of the Gaussian map.
  void set_frame(const RgbdFrame& frame, const LocalPast& past, const map::SnapshotPtr& snapshot);
  /// Corrects the frame's points for how the camera moved while they were measured; replaces the
  /// motion given before.
  void set_motion(const registration::FrameMotion& motion);
  /// What moves, of the frame: points there match nothing, until the next frame or set_moving().
  void set_moving(const registration::CellMask& moving);
  const registration::CellMask& moving() const { return moving_; }
  /// Whether there is anything to register to.
  bool has_targets() const { return !targets_->cloud().points.empty(); }
  /// Prepares the search for a frame expected at `T_local_predicted`; needs targets.
  void prepare(const SE3& T_local_predicted);

  /// Linearises at `T_local_camera`, searching anew unless the last search was next to it
  /// (`search.keep_matches_m`); error() and overlap() then use the same matches.
  registration::Linearization linearize(const SE3& T_local_camera);
  double error(const SE3& T_local_camera) const;
  /// The same from every `stride`-th point, scaled up: for the first, coarse steps.
  registration::Linearization linearize_coarse(const SE3& T_local_camera, int stride);
  /// Share of the frame's points the map explains, with the matches of the last linearize(); those
  /// that the last count_movers() found do not count.
  double overlap(const SE3& T_local_camera) const;
  /// Finds the points that move: those of set_moving(), and those that stand in space that was seen
  /// to be free and have not stayed there so far, for a frame taken at that pose. Their share.
  double count_movers(const SE3& T_local_camera);
  /// Whether that is so of a point (camera coordinates, metres); false before prepare().
  bool moves(const Eigen::Vector3f& point, const SE3& T_local_camera) const;
  /// Whether a pixel of the frame is of what set_moving() said, measured or not.
  bool moves(int u, int v) const { return moving_.at(u, v); }
  /// Notes where they are, so that what stays there becomes part of the world: once a frame, of an
  /// accepted pose.
  void note_movers(const SE3& T_local_camera);
  /// Targets matched in the last linearize(): their numbers in the search, normals and opacities.
  struct MatchedTargets {
    std::vector<int> indices;
    std::vector<Eigen::Vector3f> normals;  ///< towards the camera that saw them
    std::vector<float> opacities;
  };
  MatchedTargets matched_targets() const;
  /// What the frame's own surfaces could tell about its motion, whatever the map holds, without
  /// what set_moving() said. Every `noise_stride`-th point enters the expectation of what noise
  /// alone would tell.
  degeneracy::SurfaceInformation surface_information(int noise_stride);
  /// Removes targets that the frame last given to set_frame(), which must still exist, looks
  /// through, and extends them by it where the search last prepared finds none. `motion` is what
  /// its points are corrected for.
  void insert_keyframe(const SE3& T_local_camera, const registration::FrameMotion& motion = {});

  const registration::SourceCloud& source() const { return source_; }
  /// The plane fitted around a pixel of the frame (never one with the paper's sampling, which fits
  /// none), as the camera saw it when it saw the colour, if it moved by `lag` (twist) since.
  registration::InverseDepthPlane surface_with_colour(int u, int v, const Vector6d& lag) const;
  const TargetMap& targets() const { return *targets_; }

 private:
  bool is_moving(const Eigen::Vector3f& point) const;
  bool stands_in_free_space(const Eigen::Vector3f& point, const SE3& T_reference_camera) const;
  SE3 in_reference(const SE3& T_local_camera) const { return T_reference_local_ * T_local_camera; }

  GeometryConfig config_;
  PinholeCamera camera_;
  std::unique_ptr<registration::CloudSampler> source_sampler_, target_sampler_;
  std::unique_ptr<registration::CorrespondenceSearch> search_;
  std::unique_ptr<TargetMap> targets_;
  registration::GeometricCost cost_;
  registration::SourceCloud source_, keyframe_source_;
  registration::GeometricCost coarse_cost_;
  registration::SourceCloud coarse_source_;  // every n-th point of source_, made on demand
  const DepthImage* depth_ = nullptr;        // of the current frame
  std::int64_t frame_ = 0;                   // its index
  double time_s_ = 0;                        // its stamp
  registration::CellMask moving_;            // of the current frame
  Trial trial_;
  std::size_t movers_ = 0;            // points, as counted last
  registration::FrameMotion motion_;  // that its points are corrected for
  SE3 T_reference_local_;
  std::optional<SE3> T_searched_;  // pose of the last full search with these points
  bool prepared_ = false;
  std::vector<Eigen::Vector3f> sample_points_, sample_normals_;  // scratch of surface_information()
  std::vector<float> sample_weights_, sample_noise_;
};

}  // namespace sgs::alignment
