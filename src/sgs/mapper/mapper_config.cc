// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapper/mapper_config.h"

namespace sgs::mapper {

void InsertionConfig::declare(ParameterList& p) {
  p.add("method", method, "How new Gaussians are placed: an image quadtree, or every n-th pixel.",
        {"quadtree", "grid"});
  p.add("leaf_max_px", leaf_max_px, "Largest quadtree leaf.", "px", {2, 128});
  p.add("leaf_min_px", leaf_min_px, "Smallest quadtree leaf.", "px", {1, 64});
  p.add("split_gray", split_gray, "A cell is split where its grey values (0..1) deviate more.", "",
        {0, 1});
  p.add("split_depth", split_depth, "A cell is split where its depths differ by a larger share.",
        "", {0, 10});
  p.add("max_alpha", max_alpha, "Insert where the rendered map is less opaque than this.", "",
        {0, 1});
  p.add("rendering_level", rendering_level,
        "The map is rendered at full (0) or half (1) resolution to see where it is open.", "",
        {0, 1});
  p.add("front_ratio", front_ratio,
        "Insert where the measured depth is in front of the rendered one by this share ...", "",
        {0, 10});
  p.add("front_margin_m", front_margin_m, "... plus this distance.", "m", {0, 10});
  p.add("sigma_tangential", sigma_tangential, "Tangential standard deviation.", "leaf widths",
        {0.05, 5});
  p.add("sigma_normal", sigma_normal, "Standard deviation along the normal.", "tangential sigmas",
        {0.001, 5});
  p.add("max_slant", max_slant, "Longest stretch of a Gaussian along a slanted surface.", "",
        {1, 100});
  p.add("opacity", opacity, "Opacity at birth.", "", {0.01, 0.99});
  p.add("grid_step_px", grid_step_px,
        "Method grid: spacing of the pixels, at an image width of 640.", "px", {1, 100});
  p.add("max_depth_m", max_depth_m, "Depth measured farther away is ignored.", "m", {0.1, 100});
  p.add("fill_missing_depth", fill_missing_depth,
        "Pixels without depth borrow the nearest measurement, so that borders are not left empty.");
}

void OptimizerConfig::declare(ParameterList& p) {
  p.add("rate_mean_m", rate_mean_m, "Adam rate of the means.", "m", {0, 1});
  p.add("rate_log_scale", rate_log_scale, "Adam rate of the log scales.", "", {0, 1});
  p.add("rate_rotation", rate_rotation, "Adam rate of the quaternions.", "", {0, 1});
  p.add("rate_opacity", rate_opacity, "Adam rate of the opacity logits.", "", {0, 1});
  p.add("rate_color", rate_color, "Adam rate of the colours (0..1).", "", {0, 1});
  p.add("beta1", beta1, "Adam: decay of the first moment.", "", {0, 0.9999});
  p.add("beta2", beta2, "Adam: decay of the second moment.", "", {0, 0.99999});
  p.add("average", average, "Largest share that the parameter average keeps per step; 0 = off.", "",
        {0, 0.9999});
  p.add("max_axis_ratio", max_axis_ratio, "Cap of the largest to the middle axis; 0 = free.", "",
        {0, 1000});
  p.add("max_flatness", max_flatness,
        "Cap of the middle to the smallest axis: thinner plates show as needles when seen edge-on; "
        "0 = free.",
        "", {0, 1000});
  p.add("max_growth", max_growth, "Cap of the largest axis over its value at birth; 0 = free.", "",
        {0, 1000});
}

void ObjectiveConfig::declare(ParameterList& p) {
  p.add("color_weight", color_weight, "Weight of the colour loss.", "", {0, 100});
  p.add("color_knee", color_knee,
        "Residuals below this count as squares, those above by their size (Huber); 0 = L1.", "",
        {0, 100});
  p.add("depth_weight", depth_weight, "Weight of the depth loss.", "", {0, 100});
  p.add("depth_knee_m", depth_knee_m, "The same for depth.", "m", {0, 100});
  p.add("depth_form", depth_form, "|D - A z| / max(z, 0.3 m), or |D - z| as in the paper.",
        {"alpha_relative", "absolute"});
  p.add("dssim_weight", dssim_weight, "Weight of 1 - SSIM.", "", {0, 100});
  p.add("dssim_interval", dssim_interval, "D-SSIM on every n-th full-resolution step.", "steps",
        {1, 1000});
  p.add("color_only_where_depth", color_only_where_depth,
        "Colour counts only at pixels with depth (the paper).");
  p.add("floater_margin_m", floater_margin_m,
        "Gaussians this far in front of the measured depth get no gradient; 0 = off.", "m",
        {0, 100});
}

void ScheduleConfig::declare(ParameterList& p) {
  p.add("order", order,
        "Keyframes with few visits more often, shuffled rounds over all, or random draws.",
        {"balanced", "rounds", "random"});
  p.add("visit_bias", visit_bias,
        "Order balanced: a keyframe comes with a frequency in proportion to (visits + 4)^-bias.",
        "", {0, 4});
  p.add("half_resolution_share", half_resolution_share, "Share of steps at half resolution.", "",
        {0, 1});
  p.add("prune_interval", prune_interval, "Steps between prunings.", "steps", {1, 1000000});
  p.add("prune_opacity", prune_opacity, "Gaussians less opaque than this are removed.", "", {0, 1});
  p.add("prune_scale_m", prune_scale_m, "Gaussians with a longer axis are removed.", "m",
        {0.001, 1000});
  p.add("freeze_after_steps", freeze_after_steps,
        "Gaussians that have had this many steps are only drawn in most others; 0 = never.",
        "steps", {0, 1000000});
  p.add("freeze_interval", freeze_interval, "They are trained in every n-th step.", "steps",
        {1, 1000});
  p.add("tile_loss_floor", tile_loss_floor,
        "Every second visit of a keyframe leaves out tiles of 32 pixels whose loss is below this "
        "share of the mean; 0 = none. Not in steps with D-SSIM.",
        "", {0, 100});
  p.add(
      "look_interval", look_interval,
      "Every n-th visit of a keyframe looks at the whole map, the others at what that one saw and "
      "at what is new since.",
      "visits", {1, 1000});
  p.add("min_weight", min_weight,
        "The visits between look at those Gaussians that weigh (alpha times transmittance) so much "
        "in some pixel of that one.",
        "", {0, 0.5});
  p.add("min_transmittance", min_transmittance,
        "Training views are composited until so little light comes through.", "", {1e-6, 0.5});
  p.add("full_targets_kept", full_targets_kept,
        "Full-resolution targets kept ready; others are converted when they are visited.", "",
        {1, 10000});
}

void KeyframeRefinementConfig::declare(ParameterList& p) {
  p.add("exposure", exposure, "Fit one exposure gain per channel and keyframe.");
  p.add("exposure_prior", exposure_prior, "Weight of gain 1 against the measured gain.", "",
        {0, 100});
  p.add("exposure_step", exposure_step, "Share of the way to the new gain per visit.", "", {0, 1});
  p.add("pose", pose, "Refine the keyframes' poses.");
  p.add("pose_share", pose_share, "Share of a Gauss-Newton step that a pose moves per visit.", "",
        {0, 2});
  p.add("pose_first_visit", pose_first_visit, "Visits of a keyframe before its pose moves.", "",
        {0, 1000});
  p.add("pose_prior_rotation", pose_prior_rotation,
        "Pull of a keyframe's rotation towards the tracked one: loss per pixel.", "1/rad^2",
        {0, 1e6});
  p.add("pose_prior_translation", pose_prior_translation,
        "Pull of a keyframe's position towards the tracked one: loss per pixel.", "1/m^2",
        {0, 1e6});
}

void MapperConfig::declare(ParameterList& p) {
  p.add("iterations_per_frame", iterations_per_frame,
        "Optimisation steps per input frame in offline mode; fractions accumulate.", "1/frame",
        {0, 1000});
  p.add("first_keyframe_iterations", first_keyframe_iterations,
        "Optimisation steps spent on the first keyframe at once, so that a young map is not a raw "
        "one.",
        "", {0, 100000});
  const auto declare_group = [&p](const char* name, auto& config) {
    const auto group = p.group(name);
    config.declare(p);
  };
  declare_group("insertion", insertion);
  declare_group("optimizer", optimizer);
  declare_group("objective", objective);
  declare_group("schedule", schedule);
  declare_group("refinement", refinement);
}

MapperConfig paper_mapper_config() {
  MapperConfig c;
  c.iterations_per_frame = 1;
  c.first_keyframe_iterations = 0;
  c.insertion.method = "grid";
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
  c.objective.depth_form = "absolute";
  c.objective.color_only_where_depth = true;
  c.objective.floater_margin_m = 0.2;
  c.schedule.order = "random";
  c.schedule.half_resolution_share = 0;
  c.schedule.prune_opacity = 0.005;
  c.schedule.look_interval = 1;
  c.schedule.min_weight = 0;
  c.schedule.min_transmittance = 1e-4;
  c.refinement.exposure = false;
  c.refinement.pose = false;
  return c;
}

}  // namespace sgs::mapper
