// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/tracker/relocaliser.h"

#include <algorithm>

#include "sgs/features/visual_map.h"

namespace sgs::tracker {
namespace {

constexpr int kEnoughWidth_px = 320;
constexpr std::size_t kCompared = 6, kComparedOfMap = 12;
constexpr int kFeaturesOfMap = 1000;

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
      {frame.index, ferns_.code(frame), CompactView(frame, kept_level(frame.camera)), calibration});
}

void Relocaliser::know(const KnownView& view, const RgbdFrame& frame) {
  auto known = std::find_if(known_.begin(), known_.end(),
                            [&](const KnownViews& k) { return k.fern_seed == view.fern_seed; });
  if (known == known_.end()) {
    known_.push_back({view.fern_seed, features::Ferns(view.fern_seed), {}});
    known = known_.end() - 1;
  }
  features::OrbExtractor extractor(orb(kFeaturesOfMap));
  known->keyframes.push_back({frame.index, view.ferns, {}, nullptr, extractor.extract(frame)});
}

features::OrbConfig Relocaliser::orb(int features) const {
  features::OrbConfig out = config_.orb;
  out.features = std::min(out.features, features);
  return out;
}

// The newest one, too: a camera that was lost for a moment is mostly still there.
std::vector<Relocaliser::Keyframe*> Relocaliser::most_alike(const RgbdFrame& frame) {
  std::vector<std::pair<double, Keyframe*>> alike;
  const auto compare = [&](const features::Ferns& ferns, auto begin, auto end) {
    if (begin == end) return;
    const features::FernCode code = ferns.code(frame);
    for (auto k = begin; k != end; ++k) {
      alike.emplace_back(-features::Ferns::similarity(k->ferns, code), &*k);
    }
  };
  for (KnownViews& k : known_) compare(k.ferns, k.keyframes.begin(), k.keyframes.end());
  if (!keyframes_.empty()) compare(ferns_, keyframes_.begin(), keyframes_.end() - 1);
  std::stable_sort(alike.begin(), alike.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Keyframe*> out;
  if (!keyframes_.empty()) out.push_back(&keyframes_.back());
  for (const auto& [similarity, k] : alike) {
    if (out.size() < (known_.empty() ? kCompared : kComparedOfMap)) out.push_back(k);
  }
  return out;
}

std::optional<SE3> Relocaliser::relocalise(const RgbdFrame& frame, const LocalPast& past) {
  last_look_ = {};
  const bool has_map = !known_.empty();
  features::OrbExtractor extractor(orb(has_map ? kFeaturesOfMap : config_.memory.features));
  const CompactView view(frame, has_map ? 0 : kept_level(frame.camera));
  const features::OrbFrame current = extractor.extract(view.frame());
  if (static_cast<int>(current.keypoints.size()) < config_.pose.min_matches) return std::nullopt;
  features::VisualMap map(config_.pose);
  const std::vector<Keyframe*> compared = most_alike(frame);
  for (Keyframe* keyframe : compared) {
    if (keyframe->view.empty()) {
      map.insert(keyframe->features, past.at(keyframe->frame));
      continue;
    }
    const history::CalibrationPtr& now = past.revision().calibration;
    if (const auto change = history::depth_change(keyframe->calibration, now)) {
      keyframe->view.change_depth(*change);
      keyframe->calibration = now;
    }
    map.insert(extractor.extract(keyframe->view.frame()), past.at(keyframe->frame));
  }
  const features::VisualPose found = map.relocalise(current);
  if (!compared.empty()) {
    const auto best = static_cast<std::size_t>(std::max(found.keyframe, 0));
    last_look_ = {found.matches, found.inliers, compared[best]->frame};
  }
  if (found.verdict != features::Verdict::kOk) return std::nullopt;
  return found.T_world_camera;
}

}  // namespace sgs::tracker
