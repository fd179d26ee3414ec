// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/alignment/alignment_config.h"
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

enum class MotionStart { kConstantVelocity, kPrevious };
constexpr auto enum_names(MotionStart) {
  using enum MotionStart;
  return std::to_array<EnumName<MotionStart>>(
      {{kConstantVelocity, "constant_velocity"}, {kPrevious, "previous"}});
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

/// How the camera is found again after a loss.
struct RelocalisationConfig {
  int features = 400;
  int drawn_views = 150;

  void declare(ParameterList& p) {
    p.add("drawn_views", drawn_views,
          "Views of a given map that are drawn at most from where none was taken, so that a camera "
          "is found that looks from there; each makes loading longer; 0: none.",
          "", {0, 10000});
    p.add("relocalise_features", features,
          "ORB features per frame that a lost camera is looked for with, the strongest: its time "
          "grows with their square.",
          "", {10, 20000});
    p.removed("relocalise_keyframes", "history.memory_mb bounds all frames that are remembered");
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
  alignment::Fusion fusion = alignment::Fusion::kRemove;
  registration::SamplingConfig points;
  registration::SearchConfig search;
  registration::FactorConfig factor;
  registration::SolverConfig solver;
  MotionConfig motion;
  alignment::KeyframeConfig keyframe;
  alignment::MoversConfig movers;
  alignment::LossConfig loss;
  alignment::TargetConfig target;
  degeneracy::DegeneracyConfig degeneracy;
  registration::PhotometricConfig photometric;
  alignment::AlignmentConfig alignment;
  alignment::VisualKeyframeConfig visual_keyframes;
  RelocalisationConfig relocalisation;
  alignment::ReadoutConfig readout;
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

/// The part of Relocaliser.
struct RelocaliserConfig {
  RelocalisationConfig memory;
  features::OrbConfig orb;
  features::VisualPoseConfig pose;

  explicit RelocaliserConfig(const TrackerConfig& all);
};

/// The part of JointAligner.
alignment::AlignerConfig aligner_config(const TrackerConfig& all);

/// The part of SpectralTracker.
struct SpectralConfig {
  alignment::AlignerConfig aligner;
  MotionConfig motion;
  alignment::ReadoutConfig readout;
  DelayConfig delay;
  RelocaliserConfig relocaliser;

  explicit SpectralConfig(const TrackerConfig& all);
};

/// The part of GicpTracker, which is all that trackers by registration have in common.
struct GicpConfig {
  registration::SolverConfig solver;
  degeneracy::DegeneracyConfig degeneracy;
  MotionConfig motion;
  alignment::LossConfig loss;
  alignment::GeometryConfig geometry;

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
  alignment::AlignerConfig aligner;
  MotionConfig motion;
  RenderingConfig rendering;

  explicit RenderTrackerConfig(const TrackerConfig& all);
};

}  // namespace sgs::tracker
