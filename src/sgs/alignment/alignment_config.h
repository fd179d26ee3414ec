// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/core/config.h"
#include "sgs/degeneracy/degeneracy_config.h"
#include "sgs/registration/photometric.h"
#include "sgs/registration/registration_config.h"

namespace sgs::alignment {

enum class Fusion { kRemove, kJoint };
constexpr auto enum_names(Fusion) {
  using enum Fusion;
  return std::to_array<EnumName<Fusion>>({{kRemove, "remove"}, {kJoint, "joint"}});
}

enum class TargetSource { kOptimised, kAnchor, kGrid };
constexpr auto enum_names(TargetSource) {
  using enum TargetSource;
  return std::to_array<EnumName<TargetSource>>(
      {{kOptimised, "optimised"}, {kAnchor, "anchor"}, {kGrid, "grid"}});
}

/// When a frame extends the tracker's targets.
struct KeyframeConfig {
  double min_overlap = 0.81;
  double overlap_distance_m = 0.0316;
  bool clear_view = true;

  void declare(ParameterList& p) {
    p.add("min_overlap", min_overlap,
          "A frame becomes a tracking keyframe when the map explains a smaller share of its "
          "points.",
          "", {0, 1});
    p.add("overlap_distance_m", overlap_distance_m,
          "A point is explained by a target nearer than this.", "m", {1e-3, 1});
    p.add(
        "clear_view", clear_view,
        "A tracking keyframe removes targets of a long way ago that it looks through: old surfaces "
        "that a drifted camera sees before the new ones.");
    p.for_users({"min_overlap", "clear_view"});
  }
};

/// What moves by itself: somebody who walks through, or what was put there.
struct MoversConfig {
  bool clusters = true;
  bool second_look = true;
  bool ignore = false;
  double margin_m = 0.1;
  double margin_ratio = 0.03;
  double trial_s = 3;
  double clear_m = 0.2;

  void declare(ParameterList& p) {
    p.add("clusters", clusters,
          "Leave out what stands where the last half second's frames saw nothing, once that is a "
          "quarter of what is measured and no one motion of the camera explains it.");
    p.add("second_look", second_look,
          "Where something moves, track the last second once more, backwards in time, and believe "
          "the smoother of the two paths.");
    p.add("ignore", ignore,
          "Leave out what stands before known surface until it has stood there for trial_s.");
    p.add("margin_m", margin_m, "It stands so far before it at least.", "m", {0.01, 10});
    p.add("margin_ratio", margin_ratio, "And by this share of its distance more.", "", {0, 1});
    p.add("trial_s", trial_s, "What has stood in one place for so long belongs to the world.", "s",
          {0, 1e6});
    p.add("clear_m", clear_m,
          "Targets that a tracking keyframe looks through by more are removed, however new; 0: "
          "only those of a long way ago.",
          "m", {0, 10});
    p.for_users({"clusters", "second_look", "ignore"});
  }
  /// Whether anything is left out ever.
  bool any() const { return clusters || ignore; }
};

/// When a pose is not to be trusted.
struct LossConfig {
  int min_points = 150;
  int min_inliers = 80;
  double min_inlier_share = 0.1;

  void declare(ParameterList& p) {
    p.add("min_points", min_points, "Sampled points without which a frame is lost.", "", {6, 1e6});
    p.add("min_inliers", min_inliers, "Matched points without which a frame is lost.", "",
          {6, 1e6});
    p.add("min_inlier_share", min_inlier_share,
          "Matched share of the points without which a frame is lost.", "", {0, 1});
  }
};

/// Which points of the map frames are registered to (docs/method.md, section 7).
struct TargetConfig {
  TargetSource source = TargetSource::kGrid;
  double min_opacity = 0.09;
  double scale_sigmas = 0;
  int step_px = 4;
  double spacing = 1.0;

  void declare(ParameterList& p) {
    p.add("source", source,
          "Targets of the registration: the optimised Gaussians, the points they were born with, "
          "or points the tracker keeps itself.");
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
    p.for_users({"source"});
  }
};

/// The joint geometric and photometric alignment (docs/method.md, section 6), what it must achieve,
/// and what follows a loss.
struct AlignmentConfig {
  int coarse_stride = 9;
  int max_iterations = 10;
  int min_pixels = 40;
  double max_mean_cost = 3;
  double suspicious_cost = 1.4;
  double min_information = 2e4;
  double bridge_s = 0.5;
  int relocalise_interval = 5;

  void declare(ParameterList& p) {
    p.add("coarse_stride", coarse_stride, "Geometry at coarse levels uses every n-th point.", "",
          {1, 1000});
    p.add("max_iterations", max_iterations, "Gauss-Newton steps per pyramid level.", "", {1, 100});
    p.add("min_pixels", min_pixels, "Fewer photometric pixels are no measurement.", "", {8, 10000});
    p.add("max_mean_cost", max_mean_cost, "A larger mean photometric cost is no alignment.", "",
          {0, 100});
    p.add("suspicious_cost", suspicious_cost,
          "A frame whose photometric cost is so many times the usual one is aligned again from "
          "another start.",
          "", {1, 1000});
    p.add("min_information", min_information,
          "Information vision must give on an axis that geometry does not see, else the frame is "
          "lost.",
          "1/m^2", {0, 1e12});
    p.add("bridge_s", bridge_s, "Longest stretch carried on at constant velocity when lost.", "s",
          {0, 10});
    p.add("relocalise_interval", relocalise_interval,
          "Frames between relocalisation attempts while lost.", "frames", {1, 1000});
    p.for_users({"bridge_s", "relocalise_interval"});
  }
};

/// The keyframes whose pictures a frame is aligned to.
struct VisualKeyframeConfig {
  double keyframe_translation = 0.12;
  double keyframe_rotation_deg = 8;
  double keyframe_visible = 0.75;
  int max_references = 2;
  double revisit_distance = 0.45;
  bool patient = false;

  void declare(ParameterList& p) {
    p.add("keyframe_translation", keyframe_translation,
          "Distance from the last visual keyframe that makes a new one.", "mean depths", {0, 10});
    p.add("keyframe_rotation_deg", keyframe_rotation_deg,
          "Rotation from the last visual keyframe that makes a new one.", "deg", {0, 180});
    p.add("keyframe_visible", keyframe_visible,
          "A smaller usable share of the keyframe's pixels makes a new one.", "", {0, 1});
    p.add("max_references", max_references,
          "Keyframes a frame is aligned to: the last one and older ones near by.", "", {1, 8});
    p.add("revisit_distance", revisit_distance,
          "How far the view of an older keyframe may be off to serve again.", "image widths",
          {0, 2});
    p.add("patient", patient,
          "A camera that has hardly moved keeps its keyframe though something hides much of it.");
  }
};

/// Rolling shutter: time from the first row of a picture to the last.
struct ReadoutConfig {
  bool estimate = true;
  double fixed_s = 0;
  double prior_sigma_s = 0.01;
  double rate_sigma = 0.1;

  void declare(ParameterList& p) {
    p.add("estimate", estimate, "Learn the readout time of a rolling shutter; off: use fixed_s.");
    p.add("fixed_s", fixed_s,
          "Time from the first row of a picture to the last; 0 = global shutter.", "s",
          {-0.1, 0.1});
    p.add("prior_sigma_s", prior_sigma_s, "Uncertainty of a readout time of 0 at the start.", "s",
          {1e-6, 0.1});
    p.add("rate_sigma", rate_sigma, "Change of the turning rate within a frame interval.", "rad/s",
          {1e-4, 10});
    p.for_users({"estimate", "fixed_s"});
  }
};

/// The part of GeometricTerm and its targets.
struct GeometryConfig {
  registration::SamplingConfig points;
  registration::SearchConfig search;
  registration::FactorConfig factor;
  TargetConfig target;
  KeyframeConfig keyframe;
  MoversConfig movers;
};

/// The part of VisualTerm.
struct VisionConfig {
  registration::PhotometricConfig photometric;
  VisualKeyframeConfig keyframes;
};

/// The part of JointAligner.
struct AlignerConfig {
  Fusion fusion = Fusion::kRemove;
  AlignmentConfig alignment;
  registration::SolverConfig solver;
  degeneracy::DegeneracyConfig degeneracy;
  LossConfig loss;
  GeometryConfig geometry;
  VisionConfig vision;
};

}  // namespace sgs::alignment
