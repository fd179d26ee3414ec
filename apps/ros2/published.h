// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "sgs/core/error.h"
#include "sgs/robot/news.h"

namespace sgs::ros2 {

struct PublishOptions {
  std::optional<int> domain;
  std::string map_frame = "map", odom_frame = "odom", camera_frame = "sgs_camera_optical_frame";
  std::string prefix = "/sgs";  ///< of topics, but for /tf
};

/// News of a run as messages of ROS 2:
///   /tf           tf2_msgs/TFMessage: map to odom, odom to camera
///   PREFIX/odom   nav_msgs/Odometry
///   PREFIX/path   nav_msgs/Path, latched
///   PREFIX/cloud  sensor_msgs/PointCloud2, latched
///   PREFIX/grid   nav_msgs/OccupancyGrid, latched
class Publisher {
 public:
  virtual ~Publisher() = default;
  static Result<std::unique_ptr<Publisher>> open(const PublishOptions& options);
  virtual Status publish(const robot::News& news) = 0;
  /// Waits until those who listen have got it all, two seconds at most.
  virtual void drain() = 0;
};

}  // namespace sgs::ros2
