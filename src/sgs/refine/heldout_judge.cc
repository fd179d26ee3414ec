// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/refine/heldout_judge.h"

#include <limits>

#include "sgs/eval/image_metrics.h"
#include "sgs/refine/shutter.h"

namespace sgs::refine {
namespace {

constexpr std::size_t kAtOnce = 4;  // pictures rendered, then compared side by side

}  // namespace

HeldoutJudge::HeldoutJudge(std::vector<RefineFrame> frames, ThreadPool* pool)
    : frames_(std::move(frames)),
      pool_(pool),
      rasterizer_(render::make_cpu_rasterizer(pool)),
      colors_(pool) {}

HeldoutScores HeldoutJudge::scores(std::span<const map::Gaussian> gaussians,
                                   const map::Harmonics& harmonics,
                                   const PoseCorrection& correction,
                                   const ExposureCurve& exposures) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  if (frames_.empty()) return {kNaN, kNaN};
  std::vector<render::Rendering> renderings(kAtOnce);
  std::vector<HeldoutScores> scores(frames_.size());
  for (std::size_t first = 0; first < frames_.size(); first += kAtOnce) {
    const std::size_t count = std::min(kAtOnce, frames_.size() - first);
    for (std::size_t i = 0; i < count; ++i) {
      const RefineFrame& frame = frames_[first + i];
      const SE3 T = correction.corrected(frame.keyframe.T_world_camera, frame.timestamp_s);
      std::span<const map::Gaussian> seen = gaussians;
      if (!frame.readout.isZero(0)) {
        shift_by_shutter(gaussians, frame.keyframe.camera(), T, frame.readout, shifted_, pool_);
        seen = shifted_;
      }
      seen = colors_.seen(seen, harmonics, T.t);
      rasterizer_->render(seen, frame.keyframe.camera(), T, renderings[i]);
    }
    const auto compare = [&](int chunk, int) {
      const auto i = static_cast<std::size_t>(chunk);
      const auto pictures = frames_[first + i].keyframe.pictures();
      const auto truth = eval::to_float(pictures->color());
      const PixelMask* seen = pictures->seen.get();
      const auto& drawn = renderings[i].color;
      const auto gain = exposures.at(frames_[first + i].timestamp_s);
      scores[first + i] = {
          eval::psnr_db(truth, eval::clamped(drawn), seen),
          eval::psnr_db(truth, eval::clamped(eval::brightened(drawn, gain)), seen)};
    };
    if (pool_ != nullptr) {
      pool_->run(static_cast<int>(count), compare);
    } else {
      for (std::size_t i = 0; i < count; ++i) compare(static_cast<int>(i), 0);
    }
  }
  HeldoutScores mean;
  const auto count = static_cast<double>(scores.size());
  for (const HeldoutScores& score : scores) {
    mean.psnr_db += score.psnr_db / count;
    mean.psnr_exposed_db += score.psnr_exposed_db / count;
  }
  return mean;
}

}  // namespace sgs::refine
