// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/backend/keyframe_archive.h"

#include "sgs/registration/pixel_selection.h"

namespace sgs::backend {
namespace {

constexpr int kLevels = 4;
constexpr double kFarthest_m = 100;

/// The pixels of highest contrast, one to a block, that lie on a smooth surface.
std::vector<HostPixel> choose_pixels(const Keyframe& keyframe, const DepthImage& depth,
                                     const ArchiveConfig& config) {
  registration::PhotometricConfig selection;
  selection.block_px = config.block_px;
  selection.gradient_threshold = config.gradient_threshold;
  std::vector<HostPixel> out;
  for (const auto& pixel :
       registration::select_pixels(keyframe.gray.level(0).gray, 0, depth, selection)) {
    const double u = pixel.x, v = pixel.y;
    const auto plane = keyframe.inverse_depth.at(u, v);
    if (plane.q > 0) out.push_back({u, v, double{plane.q}});
  }
  return out;
}

}  // namespace

Keyframe make_keyframe(const RgbdFrame& frame, const SE3& T_world_camera, const Vector6d& velocity,
                       const ArchiveConfig& config) {
  Keyframe k;
  k.frame = frame.index;
  k.timestamp_s = frame.timestamp_s;
  k.T_world_camera = T_world_camera;
  k.velocity = velocity;
  k.depth_delay_s = frame.depth_delay_s;
  k.mean_depth_m = registration::mean_depth(frame.depth, kFarthest_m);
  if (k.mean_depth_m <= 0) return k;
  k.gray.build(frame.color, frame.camera, kLevels, frame.seen.get());
  k.inverse_depth = registration::InverseDepthField(frame.depth, frame.camera);
  k.pixels = choose_pixels(k, frame.depth, config);
  return k;
}

void KeyframeArchive::add(const std::shared_ptr<const RgbdFrame>& frame,
                          const SE3& T_world_camera) {
  if (pending_ && before_ && wants(pending_->T_world_camera)) {
    const double dt = frame->timestamp_s - before_->frame->timestamp_s;
    const Vector6d moved = (before_->T_world_camera.inverse() * T_world_camera).log();
    if (dt > 0 && dt <= config_.longest_gap_s) {
      auto keyframe =
          make_keyframe(*pending_->frame, pending_->T_world_camera, moved / dt, config_);
      if (keyframe.mean_depth_m > 0) keyframes_.push_back(std::move(keyframe));
    }
  }
  before_ = std::move(pending_);
  pending_ = Tracked{frame, T_world_camera};
}

void KeyframeArchive::note_gap() {
  before_.reset();
  pending_.reset();
}

void KeyframeArchive::correct(const PastCorrection& correction) {
  for (Keyframe& k : keyframes_) {
    k.T_world_camera = correction.corrected(k.T_world_camera, k.timestamp_s);
  }
  for (auto* tracked : {&before_, &pending_}) {
    if (!*tracked) continue;
    SE3& T = (*tracked)->T_world_camera;
    T = correction.corrected(T, (*tracked)->frame->timestamp_s);
  }
}

bool KeyframeArchive::wants(const SE3& T_world_camera) const {
  if (keyframes_.size() >= static_cast<std::size_t>(config_.most)) return false;
  return keyframes_.empty() ||
         view_distance(keyframes_.back(), T_world_camera) > config_.view_distance;
}

}  // namespace sgs::backend
