// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "sgs/core/config.h"

namespace sgs::mapper {

/// Where and how new Gaussians are made.
struct InsertionConfig {
  std::string method = "quadtree";  ///< quadtree | grid (the paper: every n-th pixel)
  int leaf_max_px = 16;
  int leaf_min_px = 4;
  double split_gray = 0.05;   ///< split where the grey deviation of a cell exceeds this (0..1)
  double split_depth = 0.06;  ///< or where its depth range exceeds this share
  double max_alpha = 0.7;     ///< insert where the map covers less than this
  int rendering_level = 1;    ///< the map is rendered for this at full (0) or half (1) resolution
  double front_ratio = 0.05;  ///< or where the measurement lies in front by ratio and margin
  double front_margin_m = 0.02;
  double sigma_tangential = 0.6;  ///< in leaf widths
  double sigma_normal = 0.2;      ///< in tangential sigmas
  double max_slant = 3;           ///< longest stretch along a slope
  double opacity = 0.7;
  int grid_step_px = 5;            ///< grid: spacing at 640 pixels of width
  double max_depth_m = 10;         ///< farther measurements are ignored
  bool fill_missing_depth = true;  ///< pixels without depth borrow the nearest measurement

  void declare(ParameterList& p);
};

/// Adam with a step count per Gaussian, and what is averaged and capped after each step.
struct OptimizerConfig {
  double rate_mean_m = 7e-4;
  double rate_log_scale = 2e-2;
  double rate_rotation = 5e-3;
  double rate_opacity = 0.05;
  double rate_color = 1e-2;
  double beta1 = 0.9;
  double beta2 = 0.95;
  double average = 0.98;        ///< ceiling of the averaging factor; 0 = no averaging
  double max_axis_ratio = 2.5;  ///< largest to middle axis; 0 = free
  double max_flatness = 4;      ///< middle to smallest axis; 0 = free
  double max_growth = 12;       ///< largest axis over the one it was born with; 0 = free

  void declare(ParameterList& p);
};

/// The loss (render::LossConfig) and which steps pay for structure.
struct ObjectiveConfig {
  double color_weight = 4;
  double color_knee = 0.2;  ///< residuals below it count as squares; 0 = L1
  double depth_weight = 0.2;
  double depth_knee_m = 0;
  std::string depth_form = "alpha_relative";  ///< alpha_relative | absolute
  double dssim_weight = 0;
  int dssim_interval = 1;  ///< D-SSIM on every n-th full-resolution step
  bool color_only_where_depth = false;
  double floater_margin_m = 0;

  void declare(ParameterList& p);
};

/// Which keyframe is visited when, and at which resolution.
struct ScheduleConfig {
  std::string order = "balanced";  ///< balanced | rounds (each keyframe once) | random (the paper)
  double visit_bias = 0.5;         ///< balanced: frequency ~ (visits + 4)^-bias
  double half_resolution_share = 0.95;
  int prune_interval = 200;  ///< steps between prunings
  double prune_opacity = 0.02;
  double prune_scale_m = 1.0;
  int freeze_after_steps = 0;  ///< Gaussians with so many steps rest in most others; 0 = never
  int freeze_interval = 2;     ///< in all steps but every n-th
  double tile_loss_floor = 0;  ///< tiles below this share of the mean loss rest every second visit
  int look_interval = 8;       ///< see ViewCandidates; 1 = every visit looks at the whole map
  double min_weight = 0.02;    ///< a keyframe sees what weighs so much in one of its pixels
  double min_transmittance = 4e-3;  ///< training views are composited down to this
  int full_targets_kept = 12;       ///< full-resolution targets kept ready (memory against time)

  void declare(ParameterList& p);
};

/// Exposure gains and poses of keyframes, refined along with the map.
struct KeyframeRefinementConfig {
  bool exposure = true;
  double exposure_prior = 4;   ///< weight of gain 1 against the measured gain
  double exposure_step = 0.5;  ///< share of the way per visit
  bool pose = true;
  double pose_share = 1;     ///< of a Gauss-Newton step per visit
  int pose_first_visit = 3;  ///< visits of a keyframe before its pose may move
  /// Pull towards the tracked pose, in loss per pixel of half resolution.
  double pose_prior_rotation = 50;    ///< per radian squared
  double pose_prior_translation = 5;  ///< per metre squared

  void declare(ParameterList& p);
};

/// Settings of the mapper; the defaults are the `default` preset (docs/mapping.md).
struct MapperConfig {
  double iterations_per_frame = 1.5;   ///< offline budget; fractions accumulate
  int first_keyframe_iterations = 30;  ///< spent at once when the map begins
  InsertionConfig insertion;
  OptimizerConfig optimizer;
  ObjectiveConfig objective;
  ScheduleConfig schedule;
  KeyframeRefinementConfig refinement;

  void declare(ParameterList& p);
};

/// The recipe of the paper and of GS-ICP SLAM (docs/method.md, section 7).
MapperConfig paper_mapper_config();

}  // namespace sgs::mapper
