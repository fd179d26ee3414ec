// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "sgs/core/thread_pool.h"
#include "sgs/geometry/pose_correction.h"
#include "sgs/map/gaussian.h"
#include "sgs/refine/training_frames.h"
#include "sgs/render/rasterizer.h"

namespace sgs::refine {

/// Judges a map by pictures that nothing learns from: mean PSNR over all pixels, no exposure
/// corrected, as eval's rule `heldout`.
class HeldoutJudge {
 public:
  /// `pool` must outlive it; null = one thread.
  HeldoutJudge(std::vector<RefineFrame> frames, ThreadPool* pool);

  bool empty() const { return frames_.empty(); }
  std::size_t size() const { return frames_.size(); }
  /// Mean PSNR in dB of the map seen from the frames' own poses, moved along as `correction` moves
  /// the frames around them. NaN without frames. Same bits for any number of threads.
  double psnr_db(std::span<const map::Gaussian> gaussians, const PoseCorrection& correction);

 private:
  std::vector<RefineFrame> frames_;
  ThreadPool* pool_;
  std::unique_ptr<render::Rasterizer> rasterizer_;
  std::vector<map::Gaussian> shifted_;  // scratch
};

}  // namespace sgs::refine
