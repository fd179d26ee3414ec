// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace sgs::tracker {

/// How far a camera that was given a map has come in finding itself there.
struct PlaceSearch {
  bool found = false;
  int looks = 0;           ///< frames that were compared with the map's views
  int needed_inliers = 0;  ///< features that have to agree on one pose
  /// The look that came nearest, refused or not:
  int best_inliers = 0;     ///< features that agreed
  int best_matches = 0;     ///< features that were alike
  double best_frame_s = 0;  ///< time of the frame
  double best_view_s = 0;   ///< time of the map's view that it resembled; not a number: a drawn one
  int refused = 0;          ///< looks that features agreed on, but surfaces or picture did not
};

}  // namespace sgs::tracker
