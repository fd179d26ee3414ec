// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/core/config.h"

namespace sgs::degeneracy {

/// Settings of degeneracy detection and fusion.
struct DegeneracyConfig {
  double condition_threshold = 200;
  double snr_threshold = 5;
  double hysteresis = 2;
  int noise_stride = 4;
  int min_points = 30;
  double planarity_ratio_min = 2;
  double planarity_ratio_max = 6;
  double planarity_alpha = 5;
  double planarity_full_prior = 0.5;
  bool planarity_alone = false;
  bool soft_gate = true;
  double geometry_weight = 0.6;
  double geometry_turn_share = 0.1;
  double damping = 1e-3;

  void declare(ParameterList& p) {
    p.add("condition_threshold", condition_threshold,
          "Axis k is degenerate when lambda_max / lambda_k exceeds this (tau_deg of the paper).",
          "", {1, 1e12});
    p.add("snr_threshold", snr_threshold,
          "Signal-to-noise ratio below which geometry does not see an axis at all; from twice this "
          "on it sees it fully.",
          "", {0, 1e6});
    p.add("hysteresis", hysteresis, "Factor on the threshold for axes weak in the last frame.", "",
          {1, 100});
    p.add("noise_stride", noise_stride, "Every n-th point enters the noise expectation.", "",
          {1, 1000});
    p.add("min_points", min_points, "Fewer points observe no axis.", "", {0, 1000000});
    p.add("planarity_ratio_min", planarity_ratio_min, "Eigenvalue ratio with planarity 0 (paper).",
          "", {0, 1e6});
    p.add("planarity_ratio_max", planarity_ratio_max, "Eigenvalue ratio with planarity 1 (paper).",
          "", {0, 1e6});
    p.add("planarity_alpha", planarity_alpha,
          "Steepness alpha of the planarity gate exp(-alpha (1 - eta)) (paper).", "", {0, 1000});
    p.add("planarity_full_prior", planarity_full_prior,
          "Above this planarity the paper adds the whole prior.", "", {0, 1e6});
    p.add("planarity_alone", planarity_alone,
          "Above that planarity the whole prior is added even when no axis is degenerate (paper).");
    p.add("soft_gate", soft_gate, "Weigh the paper's prior by planarity; off = weight 1.");
    p.add("geometry_weight", geometry_weight,
          "Factor on the geometric normal equations, because points share windows and noise.", "",
          {0, 1});
    p.add("geometry_turn_share", geometry_turn_share,
          "Share of the geometric normal equations that may turn the camera, too; the rest says "
          "where it is with its rotation left free.",
          "", {0, 1});
    p.add("damping", damping, "Added to the diagonal of the joint normal equations.", "", {0, 1e9});
    p.for_users({"condition_threshold", "snr_threshold", "geometry_weight"});
  }
};

}  // namespace sgs::degeneracy
