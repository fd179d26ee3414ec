// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sgs/camera/heldout.h"
#include "sgs/camera/rgbd_frame.h"
#include "sgs/core/error.h"
#include "sgs/core/thread_pool.h"
#include "sgs/eval/lpips.h"
#include "sgs/eval/metrics.h"
#include "sgs/map/gaussian.h"
#include "sgs/render/rasterizer.h"

namespace sgs::eval {

struct RunEvaluatorConfig {
  int stride = 1;        ///< every n-th frame of rules gsicp and full is rendered and compared
  int lpips_stride = 8;  ///< every n-th of those frames also gets LPIPS
  int heldout_interval = kHeldoutInterval;  ///< what the run used; 0 = nothing held out
  int pictures = 6;                         ///< frames kept for the report, spread evenly
  int picture_width_px = 480;
  double depth_min_alpha = 0.5;  ///< depth is compared where the rendering is at least this opaque
};

/// Means over frames of one rule. Empty: not measured.
struct RuleScores {
  std::optional<double> psnr_db, ssim, lpips;
  std::int64_t frames = 0;        ///< frames behind PSNR and SSIM
  std::int64_t lpips_frames = 0;  ///< frames behind LPIPS
};

/// Scores of a single frame.
struct FrameScores {
  std::int64_t index = 0;
  std::optional<double> psnr_gsicp_db, psnr_full_db, ssim_full, depth_l1_m;
};

/// Truth, rendering and error of one frame, reduced to the report's size.
struct FramePictures {
  std::int64_t index = 0;
  bool heldout = false;
  double psnr_full_db = 0;
  ColorImage truth, rendering;
  ColorImage error;   ///< mean absolute colour error, black 0 to yellow >= 0.25
  ColorImage before;  ///< the rendering of the map that was refined since; may be empty
};

struct RunEvaluation {
  /// `gsicp`: every frame; pixels without measured depth are zeroed in both pictures and counted.
  RuleScores gsicp;
  RuleScores full;                        ///< every frame, all pixels that the camera saw
  RuleScores train;                       ///< the same of the frames that were not held out
  RuleScores heldout;                     ///< the same of the frames that the mapper never saw
  std::optional<double> psnr_exposed_db;  ///< of `heldout`, with the gains of RunInput::gain_of
  std::optional<double> depth_l1_m;       ///< mean over frames of DepthError::l1_m
  std::optional<double> depth_coverage;   ///< mean over frames of DepthError::coverage
  std::int64_t frames_seen = 0;           ///< frames delivered
  std::int64_t frames_without_pose = 0;
  bool cancelled = false;  ///< the scores are of the frames until then
  std::vector<FrameScores> frames;
  std::vector<FramePictures> pictures;
  std::string protocol;  ///< one line that says how the numbers were made (strides, LPIPS or not)
  Metrics scores;        ///< what of it metrics.json holds
};

/// What evaluate_run() reads. All pointers must outlive the call; `lpips`, `pool` and the optional
/// callbacks may be empty.
struct RunInput {
  /// Fills the next frame; false at the end. Called until then, from the calling thread.
  std::function<bool(RgbdFrame&)> next_frame;
  /// Estimated pose of a frame; empty where there is none (the frame is not rendered).
  std::function<std::optional<SE3>(const RgbdFrame&)> pose_of;
  /// The frame's exposure over the map's colour, known without its picture; may be empty.
  std::function<std::optional<std::array<float, 3>>(const RgbdFrame&)> gain_of;
  /// Frames that next_frame will deliver, for spreading pictures; 0 = unknown.
  std::int64_t frames_expected = 0;
  std::span<const map::Gaussian> gaussians;
  const map::Harmonics* harmonics = nullptr;  ///< of those; null = none
  render::Rasterizer* rasterizer = nullptr;
  const Lpips* lpips = nullptr;     ///< null: LPIPS is not measured
  ThreadPool* pool = nullptr;       ///< may be the rasterizer's; null = one thread
  std::function<bool()> cancelled;  ///< true stops after the frames at work
  std::function<void(std::int64_t frames_seen)> progress;  ///< after each group of frames
};

/// Goes through a sequence once and compares the map, rendered at the estimated poses, with what
/// the camera saw. A few frames are in memory at a time. Held-out frames are always compared, with
/// LPIPS if there is one, whatever the strides. Same bits for any number of threads.
RunEvaluation evaluate_run(const RunInput& input, const RunEvaluatorConfig& config);

}  // namespace sgs::eval
