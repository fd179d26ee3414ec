// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "sgs/camera/depth_change.h"
#include "sgs/camera/rgbd_frame.h"
#include "sgs/core/spill_file.h"
#include "sgs/geometry/archive_se3.h"
#include "sgs/render/rasterizer.h"

namespace sgs::mapper {

/// The images of a keyframe in compact form: 8-bit colour, 16-bit depth, 5 bytes a pixel.
struct KeyframePictures {
  ColorImage color;
  Image<std::uint16_t> depth;  ///< in units of `depth_unit_m`, 0 = none
  float depth_unit_m = 0;
  std::shared_ptr<const PixelMask> seen = {};  ///< as RgbdFrame::seen

  bool sees(int x, int y) const { return !seen || (*seen)(x, y) != 0; }
  float depth_m(int x, int y) const { return depth_unit_m * static_cast<float>(depth(x, y)); }
};

/// A keyframe of the map: its pictures, its pose and exposure as refined so far. Training images
/// are made from it on demand.
class MapKeyframe {
 public:
  /// Both poses begin as `T_world_camera`. `max_depth_m` bounds the depth that is kept; farther
  /// measurements are dropped.
  MapKeyframe(const RgbdFrame& frame, const SE3& T_world_camera, double max_depth_m);
  /// One without pictures: take_pictures() comes next.
  explicit MapKeyframe(const PinholeCamera& camera) : camera_(camera) {}
  /// The pictures of the frame that the keyframe was made of. `max_depth_m` as above.
  void take_pictures(const RgbdFrame& frame, double max_depth_m);

  /// The images at full (0) or half (1) resolution. Half resolution averages 2x2 pixels; depth only
  /// where at least two of the four agree, so that no depth floats between fore- and background.
  render::TrainingImage training_image(int level) const;
  /// The same into an image whose memory is used again where its size fits. `room` is where parked
  /// pictures are read to: likewise.
  void write_training_image(int level, render::TrainingImage& image, KeyframePictures& room) const;
  /// Read from disk where they were parked.
  std::shared_ptr<const KeyframePictures> pictures() const;
  /// Moves the pictures to `file`, which must outlive this object.
  Status park(SpillFile& file);
  /// Nothing is learned from this keyframe any more. Its pose stays for what hangs on it. `file`:
  /// where the pictures may be parked.
  void cull(SpillFile* file);
  bool culled() const { return culled_; }
  /// Depth is known better now. Parked pictures follow whenever they are read.
  void change_depth(const std::shared_ptr<const DepthChange>& change);
  /// The same of the pictures only.
  void change_pictures(const std::shared_ptr<const DepthChange>& change);
  /// What pictures() takes in memory unless they are parked.
  std::size_t picture_bytes() const;
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
  void read_parked(KeyframePictures& pictures) const;

  PinholeCamera camera_;
  std::int64_t frame_index_ = 0;
  float depth_unit_m_ = 0;
  double mean_depth_m_ = 1;
  bool culled_ = false;
  std::shared_ptr<const PixelMask> seen_;       // of the pictures
  std::shared_ptr<KeyframePictures> pictures_;  // null where they are parked:
  const SpillFile* file_ = nullptr;
  std::int64_t color_at_ = 0, depth_at_ = 0;
  std::vector<std::shared_ptr<const DepthChange>> changes_;  // since they were parked
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

  /// View of keyframe number `index` at level 0 or 1.
  std::shared_ptr<const render::TrainingView> get(const MapKeyframe& keyframe, std::size_t index,
                                                  int level);
  /// The half-resolution view of `index`, the oldest one kept, is made anew for each visit from now
  /// on.
  void drop_half(std::size_t index);
  std::size_t first_half_kept() const { return first_half_kept_; }
  /// A view that is not asked for any more.
  void forget(std::size_t index);
  /// The pictures have changed: every view is made anew when it is needed.
  void forget();

 private:
  const render::Rasterizer& rasterizer_;
  std::size_t full_kept_;
  std::array<render::TrainingImage, 2> scratch_;  // per level
  KeyframePictures room_;                         // for parked ones
  std::vector<std::shared_ptr<const render::TrainingView>> half_;
  std::size_t first_half_kept_ = 0;
  /// Most recently used last.
  std::vector<std::pair<std::size_t, std::shared_ptr<const render::TrainingView>>> full_;
};

}  // namespace sgs::mapper
