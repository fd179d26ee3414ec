// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "sgs/camera/rgbd_frame.h"
#include "sgs/features/ferns.h"
#include "sgs/geometry/se3.h"
#include "sgs/registration/rolling_shutter.h"

namespace sgs::tracker {

/// Index under which the `number`-th view of a map stands in the path of those who have come to
/// know it: before every frame of their own.
inline std::int64_t known_view_index(std::size_t number) {
  constexpr std::int64_t kFirst = -1'000'000'000;
  return kFirst + static_cast<std::int64_t>(number);
}

/// The time under which that view stands in the path of a session that goes on with the map, and
/// may move what is in it: sessions have clocks of their own, and all of a map's views come first.
inline double known_view_time_s(std::size_t number) {
  constexpr double kFirst_s = -1e9;
  return kFirst_s + static_cast<double>(number);
}

/// A view of a finished map: what a camera saw from a place that is known.
struct KnownView {
  double timestamp_s = 0;            ///< of its session
  SE3 T_world_camera;                ///< in the world of the map
  registration::FrameMotion motion;  ///< of the camera while it was measured
  RgbdFrame frame;                   ///< what was seen; of a map from a file in grey
  features::FernCode ferns;          ///< of the picture in colour
  std::uint64_t fern_seed = 0;       ///< of the questions that `ferns` answers
};

/// How far a camera that was given a map has come in finding itself there.
struct PlaceSearch {
  bool found = false;
  int looks = 0;           ///< frames that were compared with the map's views
  int needed_inliers = 0;  ///< features that have to agree on one pose
  /// The look that came nearest, refused or not:
  int best_inliers = 0;     ///< features that agreed
  int best_matches = 0;     ///< features that were alike
  double best_frame_s = 0;  ///< time of the frame
  double best_view_s = 0;   ///< time of the map's view that it resembled
  int refused = 0;          ///< looks that features agreed on, but surfaces or picture did not
};

}  // namespace sgs::tracker
