// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/backend/keyframe_archive.h"

#include "sgs/registration/pixel_selection.h"

namespace sgs::backend {
namespace {

constexpr int kLevels = 4;
constexpr double kFarthest_m = 100;
constexpr std::size_t kMost = 200;  // each takes 2 MB, and a minute or two tells what there is

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

Keyframe make_keyframe(const RgbdFrame& frame, const Vector6d& velocity,
                       const ArchiveConfig& config) {
  Keyframe k;
  k.frame = frame.index;
  k.timestamp_s = frame.timestamp_s;
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
                          const history::Path& path) {
  if (pending_ && before_ && wants(*pending_, path)) {
    const double dt = frame->timestamp_s - before_->timestamp_s;
    const SE3 T_before_now = path.at(before_->index).inverse() * path.at(frame->index);
    if (dt > 0 && dt <= config_.longest_gap_s) {
      auto keyframe = make_keyframe(*pending_, T_before_now.log() / dt, config_);
      if (keyframe.mean_depth_m > 0) keyframes_.push_back(std::move(keyframe));
    }
  }
  before_ = std::move(pending_);
  pending_ = frame;
}

void KeyframeArchive::note_gap() {
  before_.reset();
  pending_.reset();
}

bool KeyframeArchive::wants(const RgbdFrame& frame, const history::Path& path) const {
  if (keyframes_.size() >= kMost) return false;
  if (keyframes_.empty()) return true;
  const Keyframe& last = keyframes_.back();
  return view_distance(last, path.at(last.frame).inverse() * path.at(frame.index)) >
         config_.view_distance;
}

}  // namespace sgs::backend
