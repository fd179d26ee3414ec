// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "sgs/camera/rgbd_frame.h"
#include "sgs/history/path.h"

namespace sgs::slam {

/// Whether a camera that has found itself in a map measures depth by the metre of that map. Where
/// it does not, its pose takes up what is wrong in the mean; that what is farther away is more
/// wrong remains.
class MetreCheck {
 public:
  /// A view of the map, under its index in the path.
  void know(std::int64_t index, const RgbdFrame& view);
  /// Takes in a tracked frame; `path` has the views. True with the last one that is needed.
  bool add(const RgbdFrame& frame, const SE3& T_world_camera, const history::Path& path);
  /// Depth as measured now over that of the map; empty before enough has been compared, and where
  /// what was seen is all of one depth.
  std::optional<double> ratio() const;

 private:
  struct View {
    std::int64_t index;
    std::vector<Eigen::Vector3d> points;  // of its camera
  };
  /// Sums over depths x of the map and y of the frame, each less the mean of their frame.
  struct Sums {
    double xx = 0, xy = 0;
    int count = 0;
  };

  std::vector<View> views_;
  Sums sums_;
  int frames_ = 0;
};

}  // namespace sgs::slam
