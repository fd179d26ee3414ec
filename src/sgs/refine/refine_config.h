// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/core/config.h"
#include "sgs/mapper/mapper_config.h"

namespace sgs::refine {

/// When and how often Gaussians split and go.
struct DensifyConfig {
  int interval = 100;
  double from = 0.02;
  double until = 0.6;
  double split_share = 0.05;
  double prune_opacity = 0.02;

  void declare(ParameterList& p) {
    p.add("interval", interval, "Steps between splits.", "steps", {10, 1000000});
    p.add("from", from, "Splits begin at this share of the time ...", "", {0, 1});
    p.add("until", until, "... and end at this one.", "", {0, 1});
    p.add("split_share", split_share, "At most this share of the Gaussians splits at once.", "",
          {0, 1});
    p.add("prune_opacity", prune_opacity, "Gaussians less opaque than this are removed.", "",
          {0, 1});
  }
};

/// How a finished map is learnt on (docs/refine.md). What it has in common with learning while the
/// map grows it says in the mapper's words (mapper/mapper_config.h).
struct RefineConfig {
  double steps_per_frame = 0;
  int least_steps = 3000;
  int memory_mb = 1500;
  bool rolling_shutter = false;
  int checks = 24;
  int patience = 8;
  int max_gaussians = 100000;
  int hole_views = 64;
  int harmonics = 0;
  double rate_harmonics = 1;
  double rate_end = 0.05;
  int warmup_steps = 200;
  double least_sigma_px = 0.25;
  mapper::OptimizerConfig optimizer = {.rate_mean_m = 3e-3,
                                       .rate_log_scale = 8e-2,
                                       .rate_rotation = 2e-2,
                                       .rate_opacity = 0.2,
                                       .rate_color = 4e-2,
                                       .beta2 = 0.98,
                                       .max_axis_ratio = 6,
                                       .max_flatness = 8,
                                       .max_growth = 4};
  mapper::ObjectiveConfig objective = {.color_knee = 0.1, .depth_weight = 0.1};
  mapper::KeyframeRefinementConfig keyframes = {.pose_share = 0.5, .pose_first_visit = 0};
  DensifyConfig densify;

  void declare(ParameterList& p);
};

}  // namespace sgs::refine
