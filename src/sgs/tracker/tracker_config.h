// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "sgs/core/config.h"
#include "sgs/degeneracy/degeneracy_config.h"
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

/// Which points of the map frames are registered to (METHOD section 7).
struct TargetConfig {
  std::string source = "grid";  ///< optimised | anchor | grid
  double min_opacity = 0.09;    ///< of Gaussians that serve as targets
  double spacing = 1.0;         ///< grid: nothing is inserted nearer than this many sampling steps

  void declare(ParameterList& p);
};

/// Settings of the tracker; the defaults are the `default` preset.
struct TrackerConfig {
  std::string type = "gicp";  ///< gicp | spectral | orb | cvm
  registration::SamplingConfig points;
  registration::SearchConfig search;
  registration::FactorConfig factor;
  registration::SolverConfig solver;
  MotionConfig motion;
  KeyframeConfig keyframe;
  LossConfig loss;
  TargetConfig target;
  degeneracy::DegeneracyConfig degeneracy;

  void declare(ParameterList& p);
};

/// The paper's front end with the released parameters (METHOD section 2).
TrackerConfig paper_tracker_config();

}  // namespace sgs::tracker
