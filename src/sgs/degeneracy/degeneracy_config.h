// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/core/config.h"

namespace sgs::degeneracy {

/// Settings of degeneracy detection and fusion.
struct DegeneracyConfig {
  double condition_threshold = 200;   ///< tau_deg of the paper
  double snr_threshold = 5;           ///< s0: w = 1 below it, 0 above twice it
  double hysteresis = 2;              ///< factor on s0 for axes that were weak in the last frame
  int noise_stride = 4;               ///< every n-th point enters the noise expectation
  int min_points = 30;                ///< fewer points observe nothing
  double planarity_ratio_min = 2;     ///< r at which the paper's eta is 0
  double planarity_ratio_max = 6;     ///< r at which the paper's eta is 1
  double planarity_alpha = 5;         ///< of the soft gate exp(-alpha (1 - eta))
  double planarity_full_prior = 0.5;  ///< above it the paper adds all of Omega
  bool planarity_alone = false;       ///< that planarity is enough, whatever the eigenvalues say
  bool soft_gate = true;              ///< off: included axes have weight 1
  double geometry_weight = 0.3;       ///< w_g (docs/method.md, section 6)
  double damping = 1e-3;              ///< on the diagonal

  void declare(ParameterList& p) {
    p.add("condition_threshold", condition_threshold,
          "Axis k is degenerate when lambda_max / lambda_k exceeds this (paper).", "", {1, 1e12});
    p.add("snr_threshold", snr_threshold,
          "Signal-to-noise ratio below which geometry does not see an axis at all.", "", {0, 1e6});
    p.add("hysteresis", hysteresis, "Factor on the threshold for axes weak in the last frame.", "",
          {1, 100});
    p.add("noise_stride", noise_stride, "Every n-th point enters the noise expectation.", "",
          {1, 1000});
    p.add("min_points", min_points, "Fewer points observe no axis.", "", {0, 1000000});
    p.add("planarity_ratio_min", planarity_ratio_min, "Eigenvalue ratio with planarity 0 (paper).",
          "", {0, 1e6});
    p.add("planarity_ratio_max", planarity_ratio_max, "Eigenvalue ratio with planarity 1 (paper).",
          "", {0, 1e6});
    p.add("planarity_alpha", planarity_alpha, "Steepness of the planarity gate (paper).", "",
          {0, 1000});
    p.add("planarity_full_prior", planarity_full_prior,
          "Above this planarity the paper adds the whole prior.", "", {0, 1e6});
    p.add("planarity_alone", planarity_alone,
          "Above that planarity the whole prior is added even when no axis is degenerate (paper).");
    p.add("soft_gate", soft_gate, "Weigh the paper's prior by planarity; off = weight 1.");
    p.add("geometry_weight", geometry_weight, "Factor on the geometric normal equations.", "",
          {0, 1});
    p.add("damping", damping, "Added to the diagonal of the joint normal equations.", "", {0, 1e9});
  }
};

}  // namespace sgs::degeneracy
