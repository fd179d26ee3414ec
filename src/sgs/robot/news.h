// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "sgs/core/error.h"
#include "sgs/geometry/trajectory.h"
#include "sgs/io/ply.h"
#include "sgs/occupancy/grid.h"
#include "sgs/robot/smooth_odometry.h"

// What a run tells a robot while it goes on, and how a program beside `sgs` that speaks the robot's
// language gets it: through a pipe, a letter, a 32-bit length and so many bytes for each piece.
// Frames of all: z up.
namespace sgs::robot {

struct PoseNews {
  double timestamp_s = 0;
  Standing standing;
};
/// All of it, as it is known now.
struct PathNews {
  double timestamp_s = 0;
  Trajectory poses;  ///< of the camera in the map
};
/// The map's points.
struct CloudNews {
  double timestamp_s = 0;
  std::vector<io::ColoredPoint> points;
};
struct GridNews {
  double timestamp_s = 0;
  occupancy::OccupancyGrid grid;
};
using News = std::variant<PoseNews, PathNews, CloudNews, GridNews>;

std::string encode(const News& news);

/// Cuts bytes, as they come, into news. An error where they are none, to stay.
class NewsParser {
 public:
  void push(std::string_view bytes) { buffer_.append(bytes); }
  /// Whether `news` is there; false: more bytes are needed.
  Result<bool> next(News& news);
  bool between_news() const { return buffer_.empty(); }

 private:
  std::string buffer_;
};

}  // namespace sgs::robot
