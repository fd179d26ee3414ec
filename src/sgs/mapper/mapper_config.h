// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/core/config.h"
#include "sgs/render/loss_config.h"

namespace sgs::mapper {

/// How the pixels are chosen at which new Gaussians are born.
enum class InsertionMethod { kQuadtree, kGrid };

constexpr auto enum_names(InsertionMethod) {
  using enum InsertionMethod;
  return std::to_array<EnumName<InsertionMethod>>({{kQuadtree, "quadtree"}, {kGrid, "grid"}});
}

/// The order in which keyframes are visited (mapper/schedule.h).
enum class VisitOrder { kBalanced, kRounds, kRandom };

constexpr auto enum_names(VisitOrder) {
  using enum VisitOrder;
  return std::to_array<EnumName<VisitOrder>>(
      {{kBalanced, "balanced"}, {kRounds, "rounds"}, {kRandom, "random"}});
}

/// Where and how new Gaussians are made.
struct InsertionConfig {
  InsertionMethod method = InsertionMethod::kQuadtree;
  int leaf_max_px = 16;
  int leaf_min_px = 4;
  double split_gray = 0.05;
  double split_depth = 0.06;
  double max_alpha = 0.7;
  int rendering_level = 1;
  double front_ratio = 0.05;
  double front_margin_m = 0.02;
  double sigma_tangential = 0.6;
  double sigma_normal = 0.2;
  double max_slant = 3;
  double opacity = 0.7;
  int grid_step_px = 5;
  double max_depth_m = 10;
  bool fill_missing_depth = true;

  void declare(ParameterList& p) {
    p.add("method", method,
          "How new Gaussians are placed: an image quadtree, or every n-th pixel (the paper).");
    p.add("leaf_max_px", leaf_max_px, "Largest quadtree leaf.", "px", {2, 128});
    p.add("leaf_min_px", leaf_min_px,
          "Smallest quadtree leaf; half of it where pixels are coarse (docs/mapping.md).", "px",
          {1, 64});
    p.add("split_gray", split_gray, "A cell is split where its grey values (0..1) deviate more.",
          "", {0, 1});
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
    p.add(
        "fill_missing_depth", fill_missing_depth,
        "Pixels without depth borrow the nearest measurement, so that borders are not left empty.");
    p.for_users({"method", "leaf_max_px", "leaf_min_px", "max_depth_m", "fill_missing_depth"});
  }
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
  double average = 0.98;
  double max_axis_ratio = 2.5;
  double max_flatness = 4;
  double max_growth = 12;

  void declare(ParameterList& p) {
    p.add("rate_mean_m", rate_mean_m, "Adam rate of the means.", "m", {0, 1});
    p.add("rate_log_scale", rate_log_scale, "Adam rate of the log scales.", "", {0, 1});
    p.add("rate_rotation", rate_rotation, "Adam rate of the quaternions.", "", {0, 1});
    p.add("rate_opacity", rate_opacity, "Adam rate of the opacity logits.", "", {0, 1});
    p.add("rate_color", rate_color, "Adam rate of the colours (0..1).", "", {0, 1});
    p.add("beta1", beta1, "Adam: decay of the first moment.", "", {0, 0.9999});
    p.add("beta2", beta2, "Adam: decay of the second moment.", "", {0, 0.99999});
    p.add("average", average, "Largest share that the parameter average keeps per step; 0 = off.",
          "", {0, 0.9999});
    p.add("max_axis_ratio", max_axis_ratio, "Cap of the largest to the middle axis; 0 = free.", "",
          {0, 1000});
    p.add(
        "max_flatness", max_flatness,
        "Cap of the middle to the smallest axis: thinner plates show as needles when seen edge-on; "
        "0 = free.",
        "", {0, 1000});
    p.add("max_growth", max_growth, "Cap of the largest axis over its value at birth; 0 = free.",
          "", {0, 1000});
  }
};

/// The loss (render::LossConfig) and which steps pay for structure.
struct ObjectiveConfig {
  double color_weight = 4;
  double color_knee = 0.2;
  double depth_weight = 0.2;
  double depth_knee_m = 0;
  render::DepthForm depth_form = render::DepthForm::kAlphaRelative;
  double dssim_weight = 0;
  int dssim_interval = 1;
  bool color_only_where_depth = false;
  double floater_margin_m = 0;

  void declare(ParameterList& p) {
    p.add("color_weight", color_weight, "Weight of the colour loss.", "", {0, 100});
    p.add("color_knee", color_knee,
          "Residuals below this count as squares, those above by their size (Huber); 0 = L1.", "",
          {0, 100});
    p.add("depth_weight", depth_weight, "Weight of the depth loss.", "", {0, 100});
    p.add("depth_knee_m", depth_knee_m, "The same for the depth loss.", "m", {0, 100});
    p.add("depth_form", depth_form, "|D - A z| / max(z, 0.3 m), or |D - z| as in the paper.");
    p.add("dssim_weight", dssim_weight, "Weight of 1 - SSIM.", "", {0, 100});
    p.add("dssim_interval", dssim_interval, "D-SSIM on every n-th full-resolution step.", "steps",
          {1, 1000});
    p.add("color_only_where_depth", color_only_where_depth,
          "Colour counts only at pixels with depth (the paper).");
    p.add("floater_margin_m", floater_margin_m,
          "Gaussians this far in front of the measured depth get no gradient; 0 = off.", "m",
          {0, 100});
  }
};

/// Which keyframe is visited when, and at which resolution.
struct ScheduleConfig {
  VisitOrder order = VisitOrder::kBalanced;
  double visit_bias = 0.5;
  int most_keyframes = 500;
  double half_resolution_share = 0.95;
  int prune_interval = 200;
  double prune_opacity = 0.02;
  double prune_scale_m = 1.0;
  int look_interval = 8;
  double min_weight = 0.02;
  double min_transmittance = 4e-3;
  int full_views_kept = 12;

  void declare(ParameterList& p) {
    p.add("order", order,
          "Keyframes with few visits more often, shuffled rounds over all, or random draws (the "
          "paper).");
    p.add("visit_bias", visit_bias,
          "Order balanced: a keyframe comes with a frequency in proportion to (visits + 4)^-bias.",
          "", {0, 4});
    p.add("most_keyframes", most_keyframes,
          "Keyframes that are learned from at a time; beyond, of the two that show most alike the "
          "older one is left out. More than three minutes of a live run.",
          "", {2, 1000000});
    p.add("half_resolution_share", half_resolution_share,
          "Share of steps at half resolution; none where pixels are coarse (docs/mapping.md).", "",
          {0, 1});
    p.add("prune_interval", prune_interval, "Steps between prunings.", "steps", {1, 1000000});
    p.add("prune_opacity", prune_opacity, "Gaussians less opaque than this are removed.", "",
          {0, 1});
    p.add("prune_scale_m", prune_scale_m, "Gaussians with a longer axis are removed.", "m",
          {0.001, 1000});
    p.add("look_interval", look_interval,
          "Every n-th visit of a keyframe looks at the whole map, the others at what that one saw "
          "and "
          "at what is new since; 1 = all look at the whole map.",
          "visits", {1, 1000});
    p.add(
        "min_weight", min_weight,
        "The visits between look at those Gaussians that weigh (alpha times transmittance) so much "
        "in some pixel of that one.",
        "", {0, 0.5});
    p.add("min_transmittance", min_transmittance,
          "Training views are composited until so little light comes through.", "", {1e-6, 0.5});
    p.add(
        "full_views_kept", full_views_kept,
        "Full-resolution training views kept ready, memory against time; others are converted when "
        "they are visited.",
        "", {1, 10000});
    p.renamed("full_targets_kept", "full_views_kept");
    p.removed("freeze_after_steps", "it cost quality and saved little time");
    p.removed("freeze_interval", "it cost quality and saved little time");
    p.removed("tile_loss_floor", "it saved no time");
    p.for_users({"order", "most_keyframes"});
  }
};

/// Exposure gains and poses of keyframes, refined along with the map.
struct KeyframeRefinementConfig {
  bool exposure = true;
  double exposure_prior = 4;
  double exposure_step = 0.5;
  bool pose = true;
  double pose_share = 1;
  int pose_first_visit = 3;
  double pose_prior_rotation = 50;
  double pose_prior_translation = 5;

  void declare(ParameterList& p) {
    p.add("exposure", exposure, "Fit one exposure gain per channel and keyframe.");
    p.add("exposure_prior", exposure_prior, "Weight of gain 1 against the measured gain.", "",
          {0, 100});
    p.add("exposure_step", exposure_step, "Share of the way to the new gain per visit.", "",
          {0, 1});
    p.add("pose", pose, "Refine the keyframes' poses.");
    p.add("pose_share", pose_share, "Share of a Gauss-Newton step that a pose moves per visit.", "",
          {0, 2});
    p.add("pose_first_visit", pose_first_visit, "Visits of a keyframe before its pose moves.", "",
          {0, 1000});
    p.add(
        "pose_prior_rotation", pose_prior_rotation,
        "Pull of a keyframe's rotation towards the tracked one: loss per pixel of half resolution.",
        "1/rad^2", {0, 1e6});
    p.add(
        "pose_prior_translation", pose_prior_translation,
        "Pull of a keyframe's position towards the tracked one: loss per pixel of half resolution.",
        "1/m^2", {0, 1e6});
    p.for_users({"exposure", "pose"});
  }
};

/// What becomes of surfaces that were mapped twice in places that a correction brings together.
struct MergeConfig {
  bool enabled = true;
  double apart_m = 0.01;
  double distance = 0.7;
  double color = 0.15;

  void declare(ParameterList& p) {
    p.add("enabled", enabled,
          "Where a correction lays two layers on each other, merge those of their Gaussians that "
          "show the same.");
    p.add("apart_m", apart_m, "Layers that lay closer together than this before are left alone.",
          "m", {0, 10});
    p.add("distance", distance, "Gaussians that lie closer together are merged.",
          "reaches of the smaller", {0, 1});
    p.add("color", color, "Those whose colours differ by more are left alone.", "", {0, 1});
  }
};

/// Settings of the mapper; the defaults are the `default` preset.
struct MapperConfig {
  double iterations_per_frame = 1.5;
  int first_keyframe_iterations = 30;
  InsertionConfig insertion;
  OptimizerConfig optimizer;
  ObjectiveConfig objective;
  ScheduleConfig schedule;
  KeyframeRefinementConfig refinement;
  MergeConfig merge;

  void declare(ParameterList& p) {
    p.add("iterations_per_frame", iterations_per_frame,
          "Optimisation steps per input frame in offline mode; fractions accumulate.", "1/frame",
          {0, 1000});
    p.add(
        "first_keyframe_iterations", first_keyframe_iterations,
        "Optimisation steps spent on the first keyframe at once, so that a young map is not a raw "
        "one.",
        "", {0, 100000});
    p.add_group("insertion", insertion);
    p.add_group("optimizer", optimizer);
    p.add_group("objective", objective);
    p.add_group("schedule", schedule);
    p.add_group("refinement", refinement);
    p.add_group("merge", merge);
    p.for_users({"iterations_per_frame", "first_keyframe_iterations"});
    p.removed("memory_mb", "history.memory_mb bounds all frames that are remembered");
  }
};

/// The recipe of the paper and of GS-ICP SLAM as far as they are published.
MapperConfig paper_mapper_config();

/// The same for a camera of this focal length in pixels. Sizes in pixels are meant for a depth
/// camera's 525; where pixels are coarser (below 525 / sqrt 2), half resolution shows no detail:
/// leaves may be half as large, and all steps are at full resolution.
MapperConfig for_focal_length(MapperConfig config, double focal_px);

}  // namespace sgs::mapper
