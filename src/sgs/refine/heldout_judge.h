// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "sgs/core/thread_pool.h"
#include "sgs/geometry/pose_correction.h"
#include "sgs/map/gaussian.h"
#include "sgs/refine/exposure_curve.h"
#include "sgs/refine/training_frames.h"
#include "sgs/render/rasterizer.h"
#include "sgs/render/view_color.h"

namespace sgs::refine {

/// Mean PSNR of held-out pictures in dB. NaN without pictures.
struct HeldoutScores {
  double psnr_db = 0;          ///< no exposure corrected, as eval's rule `heldout`
  double psnr_exposed_db = 0;  ///< as bright as the frames around in time
};

/// Judges a map by pictures that nothing learns from, all pixels that the camera saw.
class HeldoutJudge {
 public:
  /// `pool` must outlive it; null = one thread.
  HeldoutJudge(std::vector<RefineFrame> frames, ThreadPool* pool);

  bool empty() const { return frames_.empty(); }
  std::size_t size() const { return frames_.size(); }
  /// The map seen from the frames' own poses, moved along as `correction` moves the frames around
  /// them. Same bits for any number of threads.
  HeldoutScores scores(std::span<const map::Gaussian> gaussians, const map::Harmonics& harmonics,
                       const PoseCorrection& correction, const ExposureCurve& exposures);

 private:
  std::vector<RefineFrame> frames_;
  ThreadPool* pool_;
  std::unique_ptr<render::Rasterizer> rasterizer_;
  std::vector<map::Gaussian> shifted_;  // scratch
  render::ViewColors colors_;
};

}  // namespace sgs::refine
