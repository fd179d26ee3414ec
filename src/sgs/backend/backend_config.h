// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/core/config.h"

namespace sgs::backend {

/// Which frames the back end keeps, and which of their pixels.
struct ArchiveConfig {
  double view_distance = 0.12;
  double longest_gap_s = 0.25;
  double block_px = 24;
  double gradient_threshold = 6;

  void declare(ParameterList& p) {
    p.add("view_distance", view_distance, "How far the view moves between two keyframes.",
          "image widths", {0.01, 2});
    p.add("longest_gap_s", longest_gap_s,
          "A frame whose neighbours are further apart becomes no keyframe: how the camera moved is "
          "not known.",
          "s", {0.01, 10});
    p.add("block_px", block_px, "One pixel is followed per block of this size.", "px", {4, 200});
    p.add("gradient_threshold", gradient_threshold,
          "Smallest gradient of a pixel that is followed.", "grey/px", {0, 255});
    p.removed("most", "the first 200 tell what there is to know");
  }
};

/// Bundle adjustment of keyframes and calibration of depth.
struct CalibrationConfig {
  bool online = true;
  int first_keyframes = 8;
  int lag = 90;
  int columns = 26;
  int rows = 20;
  int keyframes = 80;
  int neighbours = 3;
  int revisits = 3;
  double information = 0.02;
  double mean_sigma = 0.004;
  double smooth_sigma = 0.003;
  double shift_sigma_px = 3;
  double delay_sigma_s = 0.01;
  double readout_sigma_rad = 0.002;

  void declare(ParameterList& p) {
    p.add("online", online,
          "Calibrate during a run, unless it is given a calibration (docs/calibration.md).");
    p.add("first_keyframes", first_keyframes,
          "Keyframes of the first attempt during a run; each further one waits for half as many "
          "more.",
          "", {8, 1000});
    p.add("lag", lag,
          "Offline a calibration is applied so many frames after the one that gave it, so that "
          "nothing depends on timing.",
          "frames", {1, 1000});
    p.add("columns", columns, "Nodes of the grid of offsets across the image.", "", {2, 64});
    p.add("rows", rows, "Nodes of the grid of offsets down the image.", "", {2, 64});
    p.add("keyframes", keyframes, "Keyframes adjusted together.", "", {3, 1000});
    p.add("neighbours", neighbours,
          "Keyframes before and after one in which its pixels are looked for.", "", {1, 20});
    p.add("revisits", revisits, "Other keyframes in which its pixels are looked for.", "", {0, 20});
    p.add("information", information,
          "Share of the residuals that count as independent of each other.", "", {1e-3, 1});
    p.add("mean_sigma", mean_sigma, "Prior standard deviation of the mean offset.", "1/m",
          {1e-6, 1});
    p.add("smooth_sigma", smooth_sigma,
          "Prior standard deviation of the difference of neighbouring offsets.", "1/m", {1e-6, 1});
    p.add("shift_sigma_px", shift_sigma_px,
          "Prior standard deviation of the shift of depth against colour.", "px", {1e-3, 100});
    p.add("delay_sigma_s", delay_sigma_s,
          "Prior standard deviation of the delay of depth after colour.", "s", {1e-6, 1});
    p.add("readout_sigma_rad", readout_sigma_rad,
          "By how much a camera turns further during a readout than its mean rate tells.", "rad",
          {1e-9, 1});
    p.for_users({"online", "keyframes"});
  }
};

/// Everything that looks at more than one view at a time.
struct BackendConfig {
  ArchiveConfig archive;
  CalibrationConfig calibration;

  void declare(ParameterList& p) {
    p.add_group("keyframes", archive);
    p.add_group("calibration", calibration);
  }
};

}  // namespace sgs::backend
