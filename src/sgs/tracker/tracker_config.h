// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/core/config.h"
#include "sgs/degeneracy/degeneracy_config.h"
#include "sgs/features/features_config.h"
#include "sgs/registration/photometric.h"
#include "sgs/registration/registration_config.h"

namespace sgs::tracker {

enum class TrackerType { kSpectral, kPaper, kGicp, kOrb, kCvm, kGiven, kRender };
constexpr auto enum_names(TrackerType) {
  using enum TrackerType;
  return std::to_array<EnumName<TrackerType>>({{kSpectral, "spectral"},
                                               {kPaper, "paper"},
                                               {kGicp, "gicp"},
                                               {kOrb, "orb"},
                                               {kCvm, "cvm"},
                                               {kGiven, "given"},
                                               {kRender, "render"}});
}

enum class Fusion { kRemove, kJoint };
constexpr auto enum_names(Fusion) {
  using enum Fusion;
  return std::to_array<EnumName<Fusion>>({{kRemove, "remove"}, {kJoint, "joint"}});
}

enum class MotionStart { kConstantVelocity, kPrevious };
constexpr auto enum_names(MotionStart) {
  using enum MotionStart;
  return std::to_array<EnumName<MotionStart>>(
      {{kConstantVelocity, "constant_velocity"}, {kPrevious, "previous"}});
}

enum class TargetSource { kOptimised, kAnchor, kGrid };
constexpr auto enum_names(TargetSource) {
  using enum TargetSource;
  return std::to_array<EnumName<TargetSource>>(
      {{kOptimised, "optimised"}, {kAnchor, "anchor"}, {kGrid, "grid"}});
}

enum class PosePriorSource { kOrb, kConstantVelocity };
constexpr auto enum_names(PosePriorSource) {
  using enum PosePriorSource;
  return std::to_array<EnumName<PosePriorSource>>({{kOrb, "orb"}, {kConstantVelocity, "cvm"}});
}

/// Start pose of a frame, and what counts as an impossible motion.
struct MotionConfig {
  MotionStart start = MotionStart::kConstantVelocity;
  double velocity_decay = 0.95;
  double max_translation_m = 0.25;
  double max_rotation_rad = 0.5;
  int max_growth = 4;

  void declare(ParameterList& p) {
    p.add("start", start, "Pose at which the registration of a frame starts.");
    p.add("velocity_decay", velocity_decay, "Share of the last motion that the start repeats.", "",
          {0, 1});
    p.add("max_translation_m", max_translation_m, "A frame that moves farther is refused.", "m",
          {1e-3, 10});
    p.add("max_rotation_rad", max_rotation_rad, "A frame that turns farther is refused.", "rad",
          {1e-3, 3.2});
    p.add("max_growth", max_growth, "Lost frames widen both limits, up to so many times.", "",
          {1, 100});
    p.for_users({"start", "max_translation_m", "max_rotation_rad"});
  }
};

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
  bool ignore = false;
  double margin_m = 0.1;
  double margin_ratio = 0.03;
  double trial_s = 3;
  double clear_m = 0.2;

  void declare(ParameterList& p) {
    p.add("clusters", clusters,
          "Leave out what stands where the last half second's frames saw nothing, once that is a "
          "quarter of what is measured and no one motion of the camera explains it.");
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
    p.for_users({"clusters", "ignore"});
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

/// How the camera is found again after a loss.
struct RelocalisationConfig {
  int features = 400;

  void declare(ParameterList& p) {
    p.add("relocalise_features", features,
          "ORB features per frame that a lost camera is looked for with, the strongest: its time "
          "grows with their square.",
          "", {10, 20000});
    p.removed("relocalise_keyframes", "history.memory_mb bounds all frames that are remembered");
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

/// By how much later depth is measured than its stamp says.
struct DelayConfig {
  bool estimate = true;
  double prior_sigma_s = 0.01;
  double information_scale = 0.02;
  double forget = 0.003;
  double most_s = 0.03;

  void declare(ParameterList& p) {
    p.add("estimate", estimate, "Learn by how much later depth is measured than its stamp says.");
    p.add("prior_sigma_s", prior_sigma_s, "Uncertainty of a delay of 0 at the start.", "s",
          {1e-6, 0.1});
    p.add("information_scale", information_scale,
          "Share of an alignment's pixels and points that count as independent of each other.", "",
          {1e-6, 1});
    p.add("forget", forget, "Share of what is known that a frame makes forget.", "", {0, 1});
    p.add("most_s", most_s, "The delay stays within this.", "s", {0, 0.1});
    p.for_users({"estimate", "most_s"});
  }
};

/// The paper's visual prior (docs/method.md, sections 4 to 6); its ablations are here, in
/// `degeneracy.soft_gate` and in `degeneracy.condition_threshold`.
struct PriorConfig {
  PosePriorSource source = PosePriorSource::kOrb;
  int first_frame = 4;
  bool planarity = true;
  bool only = false;

  void declare(ParameterList& p) {
    p.add("source", source,
          "Prior of the paper's tracker: ORB to the last frame, or constant velocity (an "
          "ablation).");
    p.add("first_frame", first_frame, "Number of the first frame with a prior, from 0.", "frames",
          {1, 1000});
    p.add("planarity", planarity,
          "Let planarity gate the prior; off = eigenvalues alone, included axes have weight 1.");
    p.add("only", only, "Take the prior's pose as it is and register nothing.");
    p.for_users({"source", "planarity", "only"});
  }
};

/// When the `orb` tracker extends its visual map, and how often it looks for itself when lost.
struct OrbTrackingConfig {
  double keyframe_translation = 0.12;
  double keyframe_rotation_deg = 8;
  double keyframe_matches = 0.6;
  int relocalise_interval = 5;

  void declare(ParameterList& p) {
    p.add("keyframe_translation", keyframe_translation,
          "Distance from the last keyframe that makes a new one.", "mean depths", {0, 10});
    p.add("keyframe_rotation_deg", keyframe_rotation_deg,
          "Rotation from the last keyframe that makes a new one.", "deg", {0, 180});
    p.add("keyframe_matches", keyframe_matches,
          "A smaller share of the matches there were right after the last keyframe makes a new "
          "one.",
          "", {0, 1});
    p.add("relocalise_interval", relocalise_interval,
          "Frames between relocalisation attempts while lost.", "frames", {1, 1000});
  }
};

/// What becomes of poses that are known already, and when they make a keyframe.
struct GivenConfig {
  bool refine = false;
  double keyframe_translation = 0.12;
  double keyframe_rotation_deg = 8;

  void declare(ParameterList& p) {
    p.add("refine", refine,
          "Let the mapper move given poses of keyframes as it does tracked ones; off: they stay as "
          "they were given.");
    p.add("keyframe_translation", keyframe_translation,
          "Distance from the last keyframe that makes a new one.", "median depths", {0, 10});
    p.add("keyframe_rotation_deg", keyframe_rotation_deg,
          "Rotation from the last keyframe that makes a new one.", "deg", {0, 180});
    p.for_users({"refine"});
  }
};

enum class RenderMethod { kGaussNewton, kAdam, kAligned };
constexpr auto enum_names(RenderMethod) {
  using enum RenderMethod;
  return std::to_array<EnumName<RenderMethod>>(
      {{kGaussNewton, "gauss_newton"}, {kAdam, "adam"}, {kAligned, "aligned"}});
}

/// How `render` looks for the pose from which the map looks most like a frame.
struct DescentConfig {
  double color_weight = 0.45;
  int newton_steps = 10;
  int adam_steps = 60;
  double adam_rotation_rate = 2e-3;
  double adam_translation_rate = 2e-3;

  void declare(ParameterList& p) {
    p.add("color_weight", color_weight,
          "Share of colour in what the rendering is judged by; the rest is depth's.", "", {0, 1});
    p.add("newton_steps", newton_steps, "Steps of method gauss_newton, a frame at most.", "",
          {1, 1000});
    p.add("adam_steps", adam_steps, "Steps of method adam, a frame.", "", {1, 10000});
    p.add("adam_rotation_rate", adam_rotation_rate, "Size of its first steps, rotation.", "rad",
          {1e-6, 0.1});
    p.add("adam_translation_rate", adam_translation_rate, "Size of its first steps, translation.",
          "m", {1e-6, 0.1});
  }
};

/// What `render` compares frames with: the map, drawn from where the camera probably is.
struct RenderingConfig {
  RenderMethod method = RenderMethod::kGaussNewton;
  int rounds = 2;
  double min_alpha = 0.95;
  double mapping_steps = 3;
  DescentConfig descent;

  void declare(ParameterList& p) {
    p.add("method", method,
          "How a pose is found: down the difference between rendering and frame, by Gauss-Newton "
          "or as in the literature by Adam (slow), or aligned to a drawing of the map.");
    p.add("rounds", rounds, "How often the map is drawn and the frame aligned to it (aligned).", "",
          {1, 10});
    p.add("min_alpha", min_alpha, "Pixels count where the drawing is at least this opaque.", "",
          {0, 1});
    p.add("mapping_steps", mapping_steps,
          "Mapping steps a frame, offline, if mapper.iterations_per_frame is less: new surface has "
          "to be sharp soon.",
          "", {0, 1000});
    descent.declare(p);
    p.for_users({"method", "mapping_steps"});
  }
};

/// Settings of all trackers, as they stand in a config file. Each tracker is given its own part.
struct TrackerConfig {
  TrackerType type = TrackerType::kSpectral;
  Fusion fusion = Fusion::kRemove;
  registration::SamplingConfig points;
  registration::SearchConfig search;
  registration::FactorConfig factor;
  registration::SolverConfig solver;
  MotionConfig motion;
  KeyframeConfig keyframe;
  MoversConfig movers;
  LossConfig loss;
  TargetConfig target;
  degeneracy::DegeneracyConfig degeneracy;
  registration::PhotometricConfig photometric;
  AlignmentConfig alignment;
  VisualKeyframeConfig visual_keyframes;
  RelocalisationConfig relocalisation;
  ReadoutConfig readout;
  DelayConfig delay;
  features::OrbConfig orb;
  features::VisualPoseConfig visual_pose;
  PriorConfig prior;
  OrbTrackingConfig orb_tracking;
  GivenConfig given;
  RenderingConfig rendering;

  void declare(ParameterList& p);
};

/// The paper's front end with the released parameters (docs/method.md, section 2).
TrackerConfig paper_tracker_config();

/// The part of GeometricTerm and its targets.
struct GeometryConfig {
  registration::SamplingConfig points;
  registration::SearchConfig search;
  registration::FactorConfig factor;
  TargetConfig target;
  KeyframeConfig keyframe;
  MoversConfig movers;

  explicit GeometryConfig(const TrackerConfig& all);
};

/// The part of VisualTerm.
struct VisionConfig {
  registration::PhotometricConfig photometric;
  VisualKeyframeConfig keyframes;

  explicit VisionConfig(const TrackerConfig& all);
};

/// The part of Relocaliser.
struct RelocaliserConfig {
  RelocalisationConfig memory;
  features::OrbConfig orb;
  features::VisualPoseConfig pose;

  explicit RelocaliserConfig(const TrackerConfig& all);
};

/// The part of SpectralTracker.
struct SpectralConfig {
  Fusion fusion;
  AlignmentConfig alignment;
  registration::SolverConfig solver;
  degeneracy::DegeneracyConfig degeneracy;
  MotionConfig motion;
  LossConfig loss;
  GeometryConfig geometry;
  VisionConfig vision;
  ReadoutConfig readout;
  DelayConfig delay;
  RelocaliserConfig relocaliser;

  explicit SpectralConfig(const TrackerConfig& all);
};

/// The part of GicpTracker, which is all that trackers by registration have in common.
struct GicpConfig {
  registration::SolverConfig solver;
  degeneracy::DegeneracyConfig degeneracy;
  MotionConfig motion;
  LossConfig loss;
  GeometryConfig geometry;

  explicit GicpConfig(const TrackerConfig& all);
};

/// The part of PaperTracker.
struct PaperConfig {
  GicpConfig registration;
  PriorConfig prior;
  features::OrbConfig orb;
  features::VisualPoseConfig visual_pose;

  explicit PaperConfig(const TrackerConfig& all);
};

/// The part of OrbTracker.
struct OrbTrackerConfig {
  MotionConfig motion;
  features::OrbConfig orb;
  features::VisualPoseConfig visual_pose;
  OrbTrackingConfig tracking;

  explicit OrbTrackerConfig(const TrackerConfig& all);
};

/// The part of RenderTracker.
struct RenderTrackerConfig {
  SpectralConfig alignment;
  RenderingConfig rendering;

  explicit RenderTrackerConfig(const TrackerConfig& all);
};

}  // namespace sgs::tracker
