// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "sgs/eval/lpips.h"
#include "sgs/runfolder/run.h"

namespace sgs::run {

/// Means over views; empty: not measured.
struct NovelScores {
  std::optional<double> psnr_db, ssim, lpips, depth_l1_m;
  int views = 0;
};

/// Compares the map of a run on a synthetic sequence with what the generator shows of the same
/// scene from beside the path: up to `count` poses of frames, spread evenly, each moved by 10 to 15
/// cm and turned by up to 8 degrees in its own camera frame, in the estimated and in the true world
/// alike. A map that was learnt by heart is good along the path only. Brightness is known up to a
/// factor, so one gain per channel is fitted to all views together. Views into a wall are left out.
/// An input that is not synthetic is an error. Same bits for any number of threads.
Result<NovelScores> score_novel_views(const Run& run, int count, const eval::Lpips* lpips,
                                      int threads);

}  // namespace sgs::run
