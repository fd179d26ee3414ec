// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapper/mapper_config.h"

#include <algorithm>
#include <cmath>

namespace sgs::mapper {

MapperConfig paper_mapper_config() {
  MapperConfig c;
  c.iterations_per_frame = 1;
  c.first_keyframe_iterations = 0;
  c.insertion.method = InsertionMethod::kGrid;
  c.insertion.opacity = 0.1;
  c.insertion.fill_missing_depth = false;
  c.optimizer.rate_mean_m = 4e-6;
  c.optimizer.rate_log_scale = 5e-3;
  c.optimizer.rate_rotation = 1e-3;
  c.optimizer.rate_opacity = 0.05;
  // 2.5e-3 on the SH coefficient; ours is plain RGB = 0.5 + 0.28209 f_dc.
  c.optimizer.rate_color = 2.5e-3 * 0.28209;
  c.optimizer.beta2 = 0.999;
  c.optimizer.average = 0;
  c.optimizer.max_axis_ratio = 0;
  c.optimizer.max_flatness = 0;
  c.optimizer.max_growth = 0;
  c.objective.color_weight = 0.8;
  c.objective.color_knee = 0;
  c.objective.depth_knee_m = 0;
  c.objective.dssim_weight = 0.2;
  c.objective.depth_weight = 0.01;
  c.objective.depth_form = render::DepthForm::kAbsolute;
  c.objective.color_only_where_depth = true;
  c.objective.floater_margin_m = 0.2;
  c.schedule.order = VisitOrder::kRandom;
  c.schedule.most_keyframes = 1000000;
  c.schedule.half_resolution_share = 0;
  c.schedule.prune_opacity = 0.005;
  c.schedule.look_interval = 1;
  c.schedule.min_weight = 0;
  c.schedule.min_transmittance = 1e-4;
  c.refinement.exposure = false;
  c.refinement.pose = false;
  c.merge.enabled = false;
  return c;
}

MapperConfig for_focal_length(MapperConfig config, double focal_px) {
  constexpr double kUsual_px = 525;  // a Kinect's at 640 pixels
  if (!(focal_px * std::sqrt(2.0) < kUsual_px)) return config;
  config.insertion.leaf_min_px = std::max(1, config.insertion.leaf_min_px / 2);
  config.schedule.half_resolution_share = 0;
  return config;
}

}  // namespace sgs::mapper
