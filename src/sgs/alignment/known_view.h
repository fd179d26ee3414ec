// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "sgs/camera/rgbd_frame.h"
#include "sgs/features/ferns.h"
#include "sgs/geometry/se3.h"
#include "sgs/registration/rolling_shutter.h"

namespace sgs::alignment {

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

/// A view of a finished map: what a camera saw, or would have seen, from a place that is known.
struct KnownView {
  double timestamp_s = 0;            ///< of its session
  SE3 T_world_camera;                ///< in the world of the map
  registration::FrameMotion motion;  ///< of the camera while it was measured
  RgbdFrame frame;                   ///< what was seen; of a map from a file in grey
  features::FernCode ferns;          ///< of the picture in colour
  std::uint64_t fern_seed = 0;       ///< of the questions that `ferns` answers
  bool drawn = false;                ///< of the map's Gaussians, where no camera was
};

}  // namespace sgs::alignment
