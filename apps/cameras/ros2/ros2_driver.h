// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "sgs/capture/camera_driver.h"
#include "topics.h"

namespace sgs::cameras {

struct Ros2Options {
  CameraTopics topics;
  std::optional<int> domain;       ///< empty: ROS_DOMAIN_ID, else 0
  std::string registered = "off";  ///< "on": depth lies on colour, whatever its frame says
  double wait_s = 10;              ///< for publishers
};

/// Cameras that nodes of ROS 2 publish, over DDS; the serial number of one is where its topics lie
/// ("/camera"). `options` are read when it starts.
std::unique_ptr<capture::CameraDriver> make_ros2_driver(std::shared_ptr<const Ros2Options> options);

}  // namespace sgs::cameras
