// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/core/config.h"
#include "sgs/map/harmonics.h"

namespace sgs::refine {

/// How a finished map is learnt on (docs/refine.md).
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

  double color_weight = 4;
  double color_knee = 0.1;
  double depth_weight = 0.1;
  double dssim_weight = 0;
  double half_resolution_until = 0;

  double rate_mean_m = 3e-3;
  double rate_log_scale = 8e-2;
  double rate_rotation = 2e-2;
  double rate_opacity = 0.2;
  double rate_color = 4e-2;
  double rate_harmonics = 1;
  double harmonics_decay = 0;
  double rate_end = 0.05;
  int warmup_steps = 200;
  double beta2 = 0.98;
  double max_axis_ratio = 6;
  double max_flatness = 8;
  double least_sigma_px = 0.25;
  double opacity_decay = 0;

  int densify_interval = 100;
  double densify_from = 0.02;
  double densify_until = 0.6;
  double split_share = 0.05;
  double split_size_power = 0.5;
  double prune_opacity = 0.02;

  bool poses = true;
  bool exposure = true;
  double pose_share = 0.5;
  double pose_prior = 1;
  double exposure_prior = 4;

  void declare(ParameterList& p) {
    p.add("steps_per_frame", steps_per_frame,
          "A run ends by refining its map, with so many steps for each of its frames; 0 = it does "
          "not.",
          "steps", {0, 1e6});
    p.add("least_steps", least_steps,
          "But not with fewer than these: a short recording has few frames to learn from, each of "
          "them as rich as any.",
          "steps", {1, 1e9});
    p.add("memory_mb", memory_mb,
          "Memory for the pictures; of a longer recording the sharpest of each n frames are used.",
          "MiB", {16, 1e6});
    p.add(
        "rolling_shutter", rolling_shutter,
        "Learn from pictures as the camera's rolling shutter took them, with the readout time that "
        "the run has learned, and judge them so: a sharper map, whose pictures by a global shutter "
        "are less like the recording's.");
    p.add("checks", checks, "How often the held-out frames are looked at.", "", {1, 1000});
    p.add("patience", patience, "Checks without anything better after which it ends; 0 = never.",
          "", {0, 1000});
    p.add("max_gaussians", max_gaussians,
          "The map grows to so many Gaussians; a larger one does not grow.", "", {1, 1e8});
    p.add("hole_views", hole_views,
          "In so many views, spread evenly, holes of the map are filled first.", "", {0, 10000});
    p.add("harmonics", harmonics,
          "Degree of the spherical harmonics by which colours depend on where they are seen from; "
          "0 = "
          "they do not.",
          "", {0, map::kMaxHarmonicDegree});
    p.add("color_weight", color_weight, "Weight of the colour loss.", "", {0, 100});
    p.add("color_knee", color_knee, "Residuals below this count as squares (Huber).", "", {0, 100});
    p.add("depth_weight", depth_weight, "Weight of the depth loss.", "", {0, 100});
    p.add("dssim_weight", dssim_weight, "Weight of 1 - SSIM.", "", {0, 100});
    p.add("half_resolution_until", half_resolution_until,
          "Every other step before this share of the time is at half resolution.", "", {0, 1});
    p.add("rate_mean_m", rate_mean_m, "Adam rate of the means at the beginning.", "m", {0, 1});
    p.add("rate_log_scale", rate_log_scale, "Adam rate of the log scales.", "", {0, 1});
    p.add("rate_rotation", rate_rotation, "Adam rate of the quaternions.", "", {0, 1});
    p.add("rate_opacity", rate_opacity, "Adam rate of the opacity logits.", "", {0, 1});
    p.add("rate_color", rate_color, "Adam rate of the colours (0..1).", "", {0, 1});
    p.add("rate_harmonics", rate_harmonics,
          "Adam rate of the harmonics' coefficients, in units of that of the colours.", "",
          {0, 10});
    p.add("harmonics_decay", harmonics_decay,
          "Share of the harmonics' coefficients that goes with each step.", "", {0, 1});
    p.add("rate_end", rate_end, "Share of all rates that is left at the end.", "", {1e-4, 1});
    p.add("warmup_steps", warmup_steps,
          "Over so many steps, or a tenth of the budget, rates rise from zero; 0 = at once.",
          "steps", {0, 1000000});
    p.add("beta2", beta2, "Adam: decay of the second moment.", "", {0, 0.99999});
    p.add("max_axis_ratio", max_axis_ratio, "Cap of the largest to the middle axis; 0 = free.", "",
          {0, 1000});
    p.add("max_flatness", max_flatness, "Cap of the middle to the smallest axis; 0 = free.", "",
          {0, 1000});
    p.add("least_sigma_px", least_sigma_px,
          "No axis gets thinner than this in the nearest view that saw it, so that the map looks "
          "right from nearer and farther, too.",
          "px", {0, 10});
    p.add("opacity_decay", opacity_decay,
          "Opacity logits sink by this with every densification; what no picture holds up goes.",
          "", {0, 1});
    p.add("densify_interval", densify_interval, "Steps between splits.", "steps", {10, 1000000});
    p.add("densify_from", densify_from, "Splits begin at this share of the time ...", "", {0, 1});
    p.add("densify_until", densify_until, "... and end at this one.", "", {0, 1});
    p.add("split_share", split_share, "At most this share of the Gaussians splits at once.", "",
          {0, 1});
    p.add("split_size_power", split_size_power,
          "What a Gaussian asks for is its picture gradient times this power of its size.", "",
          {0, 4});
    p.add("prune_opacity", prune_opacity, "Gaussians less opaque than this are removed.", "",
          {0, 1});
    p.add("poses", poses, "Refine the poses of the frames.");
    p.add("exposure", exposure, "Fit one exposure gain per channel and frame.");
    p.add("pose_share", pose_share, "Share of a Gauss-Newton step that a pose moves per visit.", "",
          {0, 2});
    p.add("pose_prior", pose_prior,
          "Pull of poses towards those of the run, in units of the mapper's "
          "(mapper.refinement.pose_prior_rotation, ..._translation).",
          "", {0, 1e6});
    p.add("exposure_prior", exposure_prior, "Weight of gain 1 against the measured gain.", "",
          {0, 100});
    p.for_users({"steps_per_frame", "least_steps", "memory_mb", "rolling_shutter", "checks",
                 "patience", "max_gaussians", "harmonics", "dssim_weight", "poses", "exposure"});
  }
};

}  // namespace sgs::refine
