// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "sgs/geometry/se3.h"
#include "sgs/history/path.h"

namespace sgs::robot {

/// Where the camera is, as robots want it (ROS REP 105): odometry never jumps, and what is learned
/// later, by loops or when the camera finds itself again, is in the correction.
struct Standing {
  SE3 T_map_odom;
  SE3 T_odom_camera;
  /// Of the camera, in its axes, a second: angular, then linear; empty where the frame before is
  /// not known.
  std::optional<Vector6d> velocity;
};

/// Takes a path apart into odometry and its correction. One thread.
class SmoothOdometry {
 public:
  /// The camera at a frame, which is in the path and comes after all before; the path may have
  /// changed meanwhile. What moved from the frame before to this one, both as they are known now,
  /// goes to the odometry, all else to the correction.
  Standing step(const history::Path& path, std::int64_t frame);
  /// The camera was lost: how it moves to the next frame is not known.
  void lose() { last_frame_.reset(); }

 private:
  std::optional<std::int64_t> last_frame_;
  double last_s_ = 0;
  SE3 last_pose_;  // in the map, as it was known
  bool begun_ = false;
  Standing now_;
};

}  // namespace sgs::robot
