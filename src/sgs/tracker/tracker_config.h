// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "sgs/core/config.h"
#include "sgs/degeneracy/degeneracy_config.h"
#include "sgs/features/features_config.h"
#include "sgs/registration/photometric.h"
#include "sgs/registration/registration_config.h"

namespace sgs::tracker {

/// Start pose of a frame, and what counts as an impossible motion.
struct MotionConfig {
  std::string start = "constant_velocity";  ///< constant_velocity | previous
  double velocity_decay = 0.95;             ///< share of the last motion that is repeated
  double max_translation_m = 0.25;          ///< a frame that moves farther is refused
  double max_rotation_rad = 0.5;

  void declare(ParameterList& p);
};

/// When a frame extends the tracker's targets.
struct KeyframeConfig {
  double min_overlap = 0.81;           ///< a frame the map explains less than this is a keyframe
  double overlap_distance_m = 0.0316;  ///< a point this near to its target is explained

  void declare(ParameterList& p);
};

/// When a pose is not to be trusted.
struct LossConfig {
  int min_points = 150;           ///< sampled points a frame must have
  int min_inliers = 80;           ///< matched points it must have
  double min_inlier_share = 0.1;  ///< matched share of its points

  void declare(ParameterList& p);
};

/// Which points of the map frames are registered to (docs/method.md, section 7).
struct TargetConfig {
  std::string source = "grid";  ///< optimised | anchor | grid
  double min_opacity = 0.09;    ///< of Gaussians that serve as targets
  double scale_sigmas = 0;      ///< optimised: least scale in depth noises (the paper's "Scale")
  int step_px = 4;              ///< grid: spacing of the pixels a keyframe contributes
  double spacing = 1.0;         ///< grid: nothing is inserted nearer than this many of its steps

  void declare(ParameterList& p);
};

/// The joint geometric and photometric tracker (docs/method.md, section 6).
struct SpectralConfig {
  int coarse_stride = 9;               ///< geometry at coarse levels uses every n-th point
  int max_iterations = 10;             ///< per pyramid level
  double keyframe_translation = 0.12;  ///< in mean depths, from the last visual keyframe
  double keyframe_rotation_deg = 8;
  double keyframe_visible = 0.75;  ///< a smaller share of the keyframe's pixels makes a new one
  int min_pixels = 40;             ///< fewer photometric pixels are no measurement
  double max_mean_cost = 3;        ///< of the photometric residuals; more is no alignment
  double suspicious_cost = 1.4;    ///< a cost so many times the usual one is tried again
  double min_information = 2e4;    ///< vision must give on an unseen axis, 1/m^2
  double bridge_s = 0.5;           ///< longest stretch carried on at constant velocity when lost
  int max_references = 2;          ///< keyframes aligned to: the last one and older ones near by
  double revisit_distance = 0.45;  ///< how far an older keyframe's view may be off
  int relocalise_interval = 5;     ///< frames between relocalisation attempts while lost
  int relocalise_keyframes = 20;   ///< newest visual keyframes kept for relocalisation

  void declare(ParameterList& p);
};

/// Rolling shutter: time from the first row of a picture to the last.
struct ReadoutConfig {
  bool estimate = true;         ///< learn it from the pictures; off: it is `fixed_s`
  double fixed_s = 0;           ///< 0 = global shutter
  double prior_sigma_s = 0.01;  ///< belief before the first picture: 0 with this uncertainty
  double rate_sigma = 0.1;      ///< change of the turning rate within a frame interval, rad/s

  void declare(ParameterList& p);
};

/// The paper's visual prior, `fusion = prior` (docs/method.md, sections 4 to 6); its ablations are
/// here, in `degeneracy.soft_gate` and in `degeneracy.condition_threshold`.
struct PriorConfig {
  std::string source = "orb";  ///< orb | cvm (constant velocity, an ablation)
  int first_frame = 4;         ///< number, from 0, of the first frame with a prior
  bool planarity = true;       ///< off: eigenvalues alone decide, included axes have weight 1
  bool only = false;           ///< pose = prior, nothing is registered

  void declare(ParameterList& p);
};

/// When the `orb` tracker extends its visual map, and how often it looks for itself when lost.
struct OrbTrackingConfig {
  double keyframe_translation = 0.12;  ///< in mean depths, from the last keyframe
  double keyframe_rotation_deg = 8;
  double keyframe_matches = 0.6;  ///< a smaller share of the first matches makes a new keyframe
  int relocalise_interval = 5;    ///< frames between relocalisation attempts while lost

  void declare(ParameterList& p);
};

/// Settings of the tracker; the defaults are the `default` preset.
struct TrackerConfig {
  std::string type = "spectral";  ///< gicp | spectral | orb | cvm
  std::string fusion = "remove";  ///< of `spectral`: remove | joint | prior (the paper)
  registration::SamplingConfig points;
  registration::SearchConfig search;
  registration::FactorConfig factor;
  registration::SolverConfig solver;
  MotionConfig motion;
  KeyframeConfig keyframe;
  LossConfig loss;
  TargetConfig target;
  degeneracy::DegeneracyConfig degeneracy;
  registration::PhotometricConfig photometric;
  SpectralConfig spectral;
  ReadoutConfig readout;
  features::OrbConfig orb;
  features::VisualPoseConfig visual_pose;
  PriorConfig prior;
  OrbTrackingConfig orb_tracking;

  void declare(ParameterList& p);
};

/// The paper's front end with the released parameters (docs/method.md, section 2).
TrackerConfig paper_tracker_config();

}  // namespace sgs::tracker
