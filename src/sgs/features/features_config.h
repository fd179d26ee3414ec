// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/core/config.h"

namespace sgs::features {

/// Settings of ORB extraction.
struct OrbConfig {
  int features = 2048;
  int clahe_below = 150;
  double clahe_clip = 2.0;
  int clahe_tiles = 8;
  int fast_threshold = 20;

  void declare(ParameterList& p) {
    p.add("features", features, "ORB features per frame.", "", {10, 20000});
    p.add("clahe_below", clahe_below,
          "Equalise the image when the last frame had fewer features than this.", "", {0, 20000});
    p.add("clahe_clip", clahe_clip, "Clip limit of the equalisation (CLAHE).", "", {0.1, 100});
    p.add("clahe_tiles", clahe_tiles, "Tiles per side of the equalisation.", "", {1, 64});
    p.add("fast_threshold", fast_threshold, "Corner threshold of FAST.", "grey", {1, 255});
    p.for_users({"features"});
  }
};

/// Settings of the pose from features.
struct VisualPoseConfig {
  int ransac_iterations = 150;
  double ransac_threshold_px = 3;
  int min_matches = 20;
  int min_inliers = 10;
  double min_depth_m = 0.1, max_depth_m = 50;
  double max_translation_m = 0.1;
  double max_rotation_deg = 10;
  double scale_factor = 1.2;
  double huber = 2.5;
  int refine_iterations = 10;
  int max_hamming = 60;
  double search_radius_px = 20;
  int local_keyframes = 5;
  int relocalisation_keyframes = 30;
  int relocalisation_min_inliers = 25;

  void declare(ParameterList& p) {
    p.add("ransac_iterations", ransac_iterations, "RANSAC iterations of PnP.", "", {1, 100000});
    p.add("ransac_threshold_px", ransac_threshold_px, "Inlier threshold of PnP.", "px", {0.1, 50});
    p.add("min_matches", min_matches, "Fewer matches with depth give no pose.", "", {4, 10000});
    p.add("min_inliers", min_inliers, "Fewer inliers give no pose.", "", {4, 10000});
    p.add("min_depth_m", min_depth_m, "Smallest depth of a matched point.", "m", {0, 100});
    p.add("max_depth_m", max_depth_m, "Largest depth of a matched point.", "m", {0, 1000});
    p.add("max_translation_m", max_translation_m, "Faster motion per frame is rejected.", "m",
          {0, 100});
    p.add("max_rotation_deg", max_rotation_deg, "Faster rotation per frame is rejected.", "deg",
          {0, 180});
    p.add("scale_factor", scale_factor, "Pixel noise is this to the power of the octave.", "",
          {1, 2});
    p.add("huber", huber, "Huber threshold in standard deviations.", "", {0.1, 100});
    p.add("refine_iterations", refine_iterations, "Gauss-Newton steps of the refinement.", "",
          {1, 100});
    p.add("max_hamming", max_hamming, "Largest descriptor distance of a match.", "bit", {0, 256});
    p.add("search_radius_px", search_radius_px, "Radius of the projected search.", "px", {1, 500});
    p.add("local_keyframes", local_keyframes, "Keyframes in the local visual map.", "", {1, 100});
    p.add("relocalisation_keyframes", relocalisation_keyframes,
          "Keyframes compared when relocalising.", "", {1, 10000});
    p.add("relocalisation_min_inliers", relocalisation_min_inliers,
          "Fewer inliers do not relocalise.", "", {4, 10000});
  }
};

}  // namespace sgs::features
