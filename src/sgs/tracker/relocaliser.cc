// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/tracker/relocaliser.h"

namespace sgs::tracker {

void Relocaliser::add_keyframe(const RgbdFrame& frame, const SE3& T_local_camera) {
  Keyframe keyframe;
  if (static_cast<int>(keyframes_.size()) >= config_.memory.keyframes) {
    keyframe = std::move(keyframes_.front());  // its images' memory is used again
    keyframes_.pop_front();
  }
  keyframe.frame = frame;
  keyframe.T_local_camera = T_local_camera;
  keyframes_.push_back(std::move(keyframe));
}

void Relocaliser::correct(const PoseCorrection& correction) {
  for (Keyframe& k : keyframes_) {
    k.T_local_camera = correction.corrected(k.T_local_camera, k.frame.timestamp_s);
  }
}

std::optional<SE3> Relocaliser::relocalise(const RgbdFrame& frame) const {
  features::OrbExtractor extractor(config_.orb);
  const features::OrbFrame current = extractor.extract(frame);
  if (static_cast<int>(current.keypoints.size()) < config_.pose.min_matches) return std::nullopt;
  // An even choice over time bounds the cost; the newest is always among them.
  constexpr std::size_t kCompared = 6;
  features::VisualMap map(config_.pose);
  const std::size_t step = std::max<std::size_t>(1, keyframes_.size() / kCompared);
  for (std::size_t back = 0; back < keyframes_.size(); back += step) {
    const Keyframe& keyframe = keyframes_[keyframes_.size() - 1 - back];
    map.insert(extractor.extract(keyframe.frame), keyframe.T_local_camera);
  }
  const features::VisualPose found = map.relocalise(current);
  if (found.verdict != features::Verdict::kOk) return std::nullopt;
  return found.T_world_camera;
}

}  // namespace sgs::tracker
