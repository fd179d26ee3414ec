// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/tracker/relocaliser.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "sgs/camera/pyramid.h"
#include "sgs/core/error.h"
#include "sgs/features/visual_map.h"

namespace sgs::tracker {
namespace {

constexpr int kEnoughWidth_px = 320;
constexpr std::size_t kRemembered = 400;  // keyframes: an hour's places, and few to compare
constexpr std::size_t kCompared = 6, kComparedOfMap = 12, kComparedDrawn = 12;
constexpr std::size_t kTried = 3, kTriedOfMap = 8;
constexpr int kFeaturesOfMap = 1000;

/// In grey, halved as often as it stays wide enough: means of grey values, every other depth.
RgbdFrame reduced(const RgbdFrame& frame) {
  int level = 0;
  while (frame.camera.halved(level + 1).width >= kEnoughWidth_px) ++level;
  GrayPyramid pyramid;
  pyramid.build(frame.color, frame.camera, level + 1, frame.seen.get());
  SGS_CHECK(pyramid.levels() == level + 1, "the image cannot be halved so often");
  RgbdFrame out;
  out.camera = frame.camera.halved(level);
  out.color = ColorImage(out.camera.width, out.camera.height);
  out.depth = DepthImage(out.camera.width, out.camera.height);
  PixelMask seen(out.camera.width, out.camera.height, std::uint8_t{0});
  for (int v = 0; v < out.camera.height; ++v) {
    for (int u = 0; u < out.camera.width; ++u) {
      out.depth(u, v) = frame.depth(u << level, v << level);
      const float gray = pyramid.level(level).gray(u, v);
      if (std::isnan(gray)) continue;
      const auto g = static_cast<std::uint8_t>(std::lround(gray));
      out.color(u, v) = {g, g, g};
      seen(u, v) = 1;
    }
  }
  if (frame.seen) out.seen = std::make_shared<const PixelMask>(std::move(seen));
  return out;
}

}  // namespace

Relocaliser::Relocaliser(const RelocaliserConfig& config)
    : config_(config), views_(std::make_shared<history::ViewStore>(history::HistoryConfig{})) {}

void Relocaliser::add_keyframe(const RgbdFrame& frame, const history::CalibrationPtr& calibration) {
  if (keyframes_.size() >= kRemembered) keyframes_.pop_front();
  keyframes_.push_back({frame.index, ferns_.code(frame), views_->keep(frame, calibration)});
}

void Relocaliser::know(const alignment::KnownView& view, const RgbdFrame& frame) {
  auto known = std::find_if(known_.begin(), known_.end(),
                            [&](const KnownViews& k) { return k.fern_seed == view.fern_seed; });
  if (known == known_.end()) {
    known_.push_back({view.fern_seed, features::Ferns(view.fern_seed), {}});
    known = known_.end() - 1;
  }
  features::OrbExtractor extractor(orb());
  known->keyframes.push_back(
      {frame.index, view.ferns, nullptr, extractor.extract(frame), nullptr, view.drawn});
}

features::OrbConfig Relocaliser::orb() const {
  features::OrbConfig orb = config_.orb;
  orb.features = std::min(orb.features, known_.empty() ? config_.memory.features : kFeaturesOfMap);
  return orb;
}

// The newest one, too: a camera that was lost for a moment is mostly still there.
std::vector<Relocaliser::Keyframe*> Relocaliser::most_alike(const RgbdFrame& frame,
                                                            const alignment::KnownView* view) {
  std::vector<std::pair<double, Keyframe*>> alike;
  const auto compare = [&](const features::FernCode& code, auto begin, auto end) {
    for (auto k = begin; k != end; ++k) {
      alike.emplace_back(-features::Ferns::similarity(k->ferns, code), &*k);
    }
  };
  for (KnownViews& k : known_) {
    const bool same_questions = view != nullptr && view->fern_seed == k.fern_seed;
    compare(same_questions ? view->ferns : k.ferns.code(frame), k.keyframes.begin(),
            k.keyframes.end());
  }
  if (keyframes_.size() > 1) {
    compare(ferns_.code(frame), keyframes_.begin(), keyframes_.end() - 1);
  }
  std::stable_sort(alike.begin(), alike.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Keyframe*> out;
  if (!keyframes_.empty()) out.push_back(&keyframes_.back());
  const std::size_t most = known_.empty() ? kCompared : kComparedOfMap;
  std::size_t drawn = 0, seen = out.size();
  for (const auto& [similarity, k] : alike) {
    std::size_t& count = k->drawn ? drawn : seen;
    if (count >= (k->drawn ? kComparedDrawn : most)) continue;
    ++count;
    out.push_back(k);
  }
  return out;
}

// False where the view is gone.
bool Relocaliser::extract(Keyframe& keyframe, const history::CalibrationPtr& calibration) const {
  if (!keyframe.view || (keyframe.features && keyframe.calibration == calibration)) return true;
  const auto frame = keyframe.view->frame(calibration);
  if (!frame) return false;
  features::OrbExtractor extractor(orb());
  keyframe.features = extractor.extract(reduced(*frame));
  keyframe.calibration = calibration;
  return true;
}

std::optional<SE3> Relocaliser::relocalise(const RgbdFrame& frame, const alignment::LocalPast& past,
                                           const alignment::KnownView* view) {
  last_look_ = {};
  features::OrbExtractor extractor(orb());
  const features::OrbFrame current = extractor.extract(known_.empty() ? reduced(frame) : frame);
  if (static_cast<int>(current.keypoints.size()) < config_.pose.min_matches) return std::nullopt;
  features::VisualMap map(config_.pose);
  std::vector<Keyframe*> compared = most_alike(frame, view);
  std::erase_if(compared, [&](Keyframe* k) { return !extract(*k, past.revision().calibration); });
  for (const Keyframe* k : compared) map.insert(*k->features, past.at(k->frame));
  // Among many views that are not of this place, some have more features alike by accident.
  const features::VisualPose found = map.relocalise(current, known_.empty() ? kTried : kTriedOfMap);
  if (!compared.empty()) {
    const auto best = static_cast<std::size_t>(std::max(found.keyframe, 0));
    last_look_ = {found.matches, found.inliers, compared[best]->frame, compared[best]->drawn};
  }
  if (found.verdict != features::Verdict::kOk) return std::nullopt;
  return found.T_world_camera;
}

}  // namespace sgs::tracker
