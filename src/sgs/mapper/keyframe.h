// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "sgs/camera/rgbd_frame.h"
#include "sgs/geometry/archive_se3.h"
#include "sgs/history/stored_view.h"
#include "sgs/render/rasterizer.h"

namespace sgs::mapper {

/// What a keyframe shows, its depth as it is known now.
struct KeyframePictures {
  history::PicturesPtr kept;
  DepthImage depth;                            ///< metres, 0: none
  std::shared_ptr<const PixelMask> seen = {};  ///< as RgbdFrame::seen

  const ColorImage& color() const { return kept->color; }
  bool sees(int x, int y) const { return !seen || (*seen)(x, y) != 0; }
};

/// What a keyframe remembers of its frame, and how that becomes what it shows.
struct KeyframeView {
  history::StoredViewPtr kept;
  double max_depth_m = 0;                    ///< what is farther counts as not measured
  history::CalibrationPtr calibration = {};  ///< of depth, in force
  Vector6d lag = Vector6d::Zero();           ///< of the camera, from colour to depth

  /// What it shows; empty where the view is gone.
  std::optional<KeyframePictures> pictures() const;
};

/// A keyframe of the map: the view that it remembers, its pose and exposure as refined so far.
/// Training images are made from it on demand.
class MapKeyframe {
 public:
  /// Both poses begin as `T_world_camera`. The view is nobody else's; of its depth nothing farther
  /// than `max_depth_m` is used.
  MapKeyframe(const RgbdFrame& frame, const SE3& T_world_camera, double max_depth_m);
  MapKeyframe(KeyframeView view, const SE3& T_world_camera);
  /// One without a view: take_view() comes next.
  explicit MapKeyframe(const PinholeCamera& camera) : camera_(camera) {}
  /// The view of the frame that the keyframe was made of.
  void take_view(KeyframeView view) { view_ = std::move(view); }

  /// The images at full (0) or half (1) resolution. Half resolution averages 2x2 pixels; depth only
  /// where at least two of the four agree, so that no depth floats between fore- and background.
  /// Empty where the view is gone.
  std::optional<render::TrainingImage> training_image(int level) const;
  /// The same into an image whose memory is used again where its size fits; false where the view is
  /// gone.
  bool write_training_image(int level, render::TrainingImage& image) const;
  /// Empty where the view is gone.
  std::optional<KeyframePictures> pictures() const { return view_.pictures(); }
  /// Nothing is learned from this keyframe any more: its view goes. Its pose stays for what hangs
  /// on it.
  void cull();
  bool culled() const { return culled_; }
  /// That of its depth which is in force.
  void see_with(const history::CalibrationPtr& calibration) { view_.calibration = calibration; }
  /// Of the pixels that have one, as measured first.
  double mean_depth_m() const { return mean_depth_m_; }
  const PinholeCamera& camera() const { return camera_; }
  std::int64_t frame_index() const { return frame_index_; }

  SE3 T_world_camera;                     ///< refined
  SE3 T_odom_camera;                      ///< where the tracker holds it to be
  std::array<float, 3> gain = {1, 1, 1};  ///< measured colour = gain * scene colour
  int visits = 0;                         ///< optimisation steps so far
  /// Of its half-resolution view (pose_information), made when it is needed first; null before
  /// that, and once the keyframe is culled.
  std::shared_ptr<const Matrix6d> pose_information;

  /// Everything but the pictures.
  template <class Archive>
  void archive(Archive& a) {
    std::optional<Matrix6d> information;
    if (pose_information) information = *pose_information;
    a(frame_index_, mean_depth_m_, culled_, T_world_camera, T_odom_camera, gain, visits,
      information);
    if constexpr (Archive::kReads) {
      pose_information = information ? std::make_shared<Matrix6d>(*information) : nullptr;
    }
  }

 private:
  PinholeCamera camera_;
  std::int64_t frame_index_ = 0;
  double mean_depth_m_ = 1;
  bool culled_ = false;
  KeyframeView view_;
};

/// Memory of a training view at half resolution.
std::size_t half_view_bytes(const PinholeCamera& camera);

/// Pixels of `camera` per pixel of a rendering for it at full (1) or half (2) resolution.
inline int rendering_scale(const render::Rendering& rendering, const PinholeCamera& camera) {
  return rendering.alpha.width() == camera.width ? 1 : 2;
}

/// Training views of the keyframes: half resolution for every keyframe but the oldest ones that
/// were dropped, full resolution for the most recently used ones.
class TrainingViewCache {
 public:
  TrainingViewCache(const render::Rasterizer& rasterizer, std::size_t full_kept)
      : rasterizer_(rasterizer), full_kept_(full_kept) {}

  /// View of keyframe number `index` at level 0 or 1; null where what it was made of is gone.
  std::shared_ptr<const render::TrainingView> get(const MapKeyframe& keyframe, std::size_t index,
                                                  int level);
  /// From now on the oldest half-resolution views are made anew for each visit, as many as hold
  /// `bytes`; but for the newest ones, which are visited most.
  void drop_halves(std::size_t bytes, const std::vector<MapKeyframe>& keyframes);
  /// What the half-resolution views of all keyframes take that are kept.
  std::size_t half_bytes(const std::vector<MapKeyframe>& keyframes) const;
  std::size_t first_half_kept() const { return first_half_kept_; }
  /// A view that is not asked for any more.
  void forget(std::size_t index);
  /// The pictures have changed: every view is made anew when it is needed.
  void forget();

 private:
  const render::Rasterizer& rasterizer_;
  std::size_t full_kept_;
  std::array<render::TrainingImage, 2> scratch_;  // per level
  std::vector<std::shared_ptr<const render::TrainingView>> half_;
  std::size_t first_half_kept_ = 0;
  /// Most recently used last.
  std::vector<std::pair<std::size_t, std::shared_ptr<const render::TrainingView>>> full_;
};

}  // namespace sgs::mapper
