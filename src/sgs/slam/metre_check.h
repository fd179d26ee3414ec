// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "sgs/camera/rgbd_frame.h"
#include "sgs/history/path.h"

namespace sgs::slam {

/// Whether a camera that has found itself in a map measures depth by the metre of that map. Its
/// pose takes up a part of what is wrong, so pose and scale are asked for together: points of the
/// map's views against the planes that the frame sees there.
class MetreCheck {
 public:
  /// `frames`: how many have to be compared before anything is said.
  explicit MetreCheck(int frames = 30) : needed_(frames) {}

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
  std::vector<View> views_;
  // Normal equation of the scale, whatever the poses are: information and gradient of so many
  // points.
  double H_ = 0, b_ = 0;
  int count_ = 0;
  int frames_ = 0, needed_;
};

}  // namespace sgs::slam
