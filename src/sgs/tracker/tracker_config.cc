// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/tracker/tracker_config.h"

namespace sgs::tracker {

void MotionConfig::declare(ParameterList& p) {
  p.add("start", start, "Pose at which the registration of a frame starts.",
        {"constant_velocity", "previous"});
  p.add("velocity_decay", velocity_decay, "Share of the last motion that the start repeats.", "",
        {0, 1});
  p.add("max_translation_m", max_translation_m, "A frame that moves farther is refused.", "m",
        {1e-3, 10});
  p.add("max_rotation_rad", max_rotation_rad, "A frame that turns farther is refused.", "rad",
        {1e-3, 3.2});
}

void KeyframeConfig::declare(ParameterList& p) {
  p.add("min_overlap", min_overlap,
        "A frame becomes a tracking keyframe when the map explains a smaller share of its points.",
        "", {0, 1});
  p.add("overlap_distance_m", overlap_distance_m,
        "A point is explained by a target nearer than this.", "m", {1e-3, 1});
}

void LossConfig::declare(ParameterList& p) {
  p.add("min_points", min_points, "Sampled points without which a frame is lost.", "", {6, 1e6});
  p.add("min_inliers", min_inliers, "Matched points without which a frame is lost.", "", {6, 1e6});
  p.add("min_inlier_share", min_inlier_share,
        "Matched share of the points without which a frame is lost.", "", {0, 1});
}

void TargetConfig::declare(ParameterList& p) {
  p.add("source", source,
        "Targets of the registration: the optimised Gaussians, the points they were born with, or "
        "points the tracker keeps itself.",
        {"optimised", "anchor", "grid"});
  p.add("min_opacity", min_opacity, "Least opacity of Gaussians that serve as targets.", "",
        {0, 1});
  p.add("scale_sigmas", scale_sigmas,
        "Least scale of optimised Gaussians as targets, in standard deviations of the depth they "
        "were born from; 0 = as they are (the paper's ablation \"Scale\").",
        "", {0, 100});
  p.add("step_px", step_px, "Spacing of the pixels that a keyframe adds as own points.", "px",
        {2, 64});
  p.add("spacing", spacing, "No own point is added nearer than this to another one.", "steps",
        {0, 10});
}

void SpectralConfig::declare(ParameterList& p) {
  p.add("coarse_stride", coarse_stride, "Geometry at coarse levels uses every n-th point.", "",
        {1, 1000});
  p.add("max_iterations", max_iterations, "Gauss-Newton steps per pyramid level.", "", {1, 100});
  p.add("keyframe_translation", keyframe_translation,
        "Distance from the last visual keyframe that makes a new one.", "mean depths", {0, 10});
  p.add("keyframe_rotation_deg", keyframe_rotation_deg,
        "Rotation from the last visual keyframe that makes a new one.", "deg", {0, 180});
  p.add("keyframe_visible", keyframe_visible,
        "A smaller usable share of the keyframe's pixels makes a new one.", "", {0, 1});
  p.add("min_pixels", min_pixels, "Fewer photometric pixels are no measurement.", "", {8, 10000});
  p.add("max_mean_cost", max_mean_cost, "A larger mean photometric cost is no alignment.", "",
        {0, 100});
  p.add("suspicious_cost", suspicious_cost,
        "A frame whose photometric cost is so many times the usual one is aligned again from "
        "another start.",
        "", {1, 1000});
  p.add(
      "min_information", min_information,
      "Information vision must give on an axis that geometry does not see, else the frame is lost.",
      "1/m^2", {0, 1e12});
  p.add("bridge_s", bridge_s, "Longest stretch carried on at constant velocity when lost.", "s",
        {0, 10});
  p.add("max_references", max_references, "Keyframes a frame is aligned to.", "", {1, 8});
  p.add("revisit_distance", revisit_distance,
        "How far the view of an older keyframe may be off to serve again.", "image widths", {0, 2});
  p.add("relocalise_interval", relocalise_interval,
        "Frames between relocalisation attempts while lost.", "frames", {1, 1000});
  p.add("relocalise_keyframes", relocalise_keyframes,
        "Newest visual keyframes kept for relocalisation.", "", {1, 1000});
}

void ReadoutConfig::declare(ParameterList& p) {
  p.add("estimate", estimate, "Learn the readout time of a rolling shutter; off: use fixed_s.");
  p.add("fixed_s", fixed_s, "Time from the first row of a picture to the last; 0 = global shutter.",
        "s", {-0.1, 0.1});
  p.add("prior_sigma_s", prior_sigma_s, "Uncertainty of a readout time of 0 at the start.", "s",
        {1e-6, 0.1});
  p.add("rate_sigma", rate_sigma, "Change of the turning rate within a frame interval.", "rad/s",
        {1e-4, 10});
}

void PriorConfig::declare(ParameterList& p) {
  p.add("source", source,
        "Prior of the paper's fusion: ORB to the last frame, or constant velocity.",
        {"orb", "cvm"});
  p.add("first_frame", first_frame, "Number of the first frame with a prior, from 0.", "frames",
        {1, 1000});
  p.add("planarity", planarity,
        "Let planarity gate the prior; off = eigenvalues alone, included axes have weight 1.");
  p.add("only", only, "Take the prior's pose as it is and register nothing.");
}

void OrbTrackingConfig::declare(ParameterList& p) {
  p.add("keyframe_translation", keyframe_translation,
        "Distance from the last keyframe that makes a new one.", "mean depths", {0, 10});
  p.add("keyframe_rotation_deg", keyframe_rotation_deg,
        "Rotation from the last keyframe that makes a new one.", "deg", {0, 180});
  p.add("keyframe_matches", keyframe_matches,
        "A smaller share of the matches there were right after the last keyframe makes a new one.",
        "", {0, 1});
  p.add("relocalise_interval", relocalise_interval,
        "Frames between relocalisation attempts while lost.", "frames", {1, 1000});
}

void TrackerConfig::declare(ParameterList& p) {
  p.add("type", type, "Tracker.", {"gicp", "spectral", "orb", "cvm"});
  p.add("fusion", fusion,
        "How `spectral` joins geometry and vision: geometry removed from its unseen axes, plain "
        "sum, or the paper's prior on degenerate axes.",
        {"remove", "joint", "prior"});
  const auto in_group = [&p](const char* name, auto& config) {
    const auto group = p.group(name);
    config.declare(p);
  };
  in_group("points", points);
  in_group("search", search);
  in_group("factor", factor);
  in_group("solver", solver);
  in_group("motion", motion);
  in_group("keyframe", keyframe);
  in_group("loss", loss);
  in_group("target", target);
  in_group("degeneracy", degeneracy);
  in_group("photometric", photometric);
  in_group("spectral", spectral);
  in_group("readout", readout);
  in_group("orb", orb);
  in_group("visual_pose", visual_pose);
  in_group("prior", prior);
  in_group("orb_tracking", orb_tracking);
}

TrackerConfig paper_tracker_config() {
  TrackerConfig c;
  c.points.method = "neighbours";
  c.points.step_px = 5;
  c.points.min_depth_m = 0.01;
  c.points.max_depth_m = 3.0;
  c.search.method = "nearest";
  c.search.min_normal_cosine = -1;
  c.search.keep_matches_m = 0;
  c.factor.type = "gicp";
  c.factor.huber = 1.345;
  c.factor.reject = 1e9;
  c.solver = {.method = "levenberg_marquardt",
              .max_iterations = 64,
              .damping = 1e-3,
              .max_step_rad = 0.1,
              .max_step_m = 0.03,
              .stop_rad = 2e-3,
              .stop_m = 5e-4};
  c.fusion = "prior";
  c.degeneracy.planarity_alone = true;
  c.motion.start = "previous";
  c.target.source = "optimised";
  c.target.step_px = c.points.step_px;
  return c;
}

}  // namespace sgs::tracker
