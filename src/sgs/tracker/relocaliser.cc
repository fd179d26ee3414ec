// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/tracker/relocaliser.h"

#include <algorithm>

#include "sgs/features/visual_map.h"

namespace sgs::tracker {
namespace {

constexpr int kEnoughWidth_px = 320;
constexpr std::size_t kCompared = 6;

/// How often an image is halved before it is kept.
int kept_level(const PinholeCamera& camera) {
  int level = 0;
  while (camera.halved(level + 1).width >= kEnoughWidth_px) ++level;
  return level;
}

}  // namespace

void Relocaliser::add_keyframe(const RgbdFrame& frame, const history::CalibrationPtr& calibration) {
  if (static_cast<int>(keyframes_.size()) >= config_.memory.keyframes) keyframes_.pop_front();
  keyframes_.push_back(
      {frame.index, CompactView(frame, kept_level(frame.camera)), calibration, ferns_.code(frame)});
}

// The newest one, too: a camera that was lost for a moment is mostly still there.
std::vector<std::size_t> Relocaliser::most_alike(const RgbdFrame& frame) const {
  const features::FernCode code = ferns_.code(frame);
  std::vector<std::pair<double, std::size_t>> alike;
  for (std::size_t k = 0; k + 1 < keyframes_.size(); ++k) {
    alike.emplace_back(-features::Ferns::similarity(keyframes_[k].ferns, code), k);
  }
  std::sort(alike.begin(), alike.end());
  std::vector<std::size_t> out;
  if (!keyframes_.empty()) out.push_back(keyframes_.size() - 1);
  for (const auto& [similarity, k] : alike) {
    if (out.size() < kCompared) out.push_back(k);
  }
  return out;
}

std::optional<SE3> Relocaliser::relocalise(const RgbdFrame& frame, const LocalPast& past) {
  features::OrbConfig orb = config_.orb;
  orb.features = std::min(orb.features, config_.memory.features);
  features::OrbExtractor extractor(orb);
  const CompactView view(frame, kept_level(frame.camera));
  const features::OrbFrame current = extractor.extract(view.frame());
  if (static_cast<int>(current.keypoints.size()) < config_.pose.min_matches) return std::nullopt;
  features::VisualMap map(config_.pose);
  for (const std::size_t k : most_alike(frame)) {
    Keyframe& keyframe = keyframes_[k];
    const history::CalibrationPtr& now = past.revision().calibration;
    if (const auto change = history::depth_change(keyframe.calibration, now)) {
      keyframe.view.change_depth(*change);
      keyframe.calibration = now;
    }
    map.insert(extractor.extract(keyframe.view.frame()), past.at(keyframe.frame));
  }
  const features::VisualPose found = map.relocalise(current);
  if (found.verdict != features::Verdict::kOk) return std::nullopt;
  return found.T_world_camera;
}

}  // namespace sgs::tracker
