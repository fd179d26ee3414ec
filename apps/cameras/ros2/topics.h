// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ros2/dds_node.h"
#include "sgs/core/error.h"

namespace sgs::cameras {

/// The topics of a camera. Empty: to be found, or not there.
struct CameraTopics {
  std::string color, depth;            ///< sensor_msgs/msg/Image or CompressedImage
  std::string color_info, depth_info;  ///< sensor_msgs/msg/CameraInfo
  std::string imu;                     ///< sensor_msgs/msg/Imu
};

/// Where the topics of a camera lie ("/camera"), for each whose colour and depth are published
/// under names that drivers use.
std::vector<std::string> camera_names(const std::vector<ros2::Offer>& offers);

/// What is asked for, completed by what is published; empty while colour, its camera info or depth
/// is not there yet. `name`: the camera's, empty: the only one. Fails where there are several.
Result<std::optional<CameraTopics>> complete(const CameraTopics& asked, const std::string& name,
                                             const std::vector<ros2::Offer>& offers);

/// Whether the images of a topic are published packed.
bool is_compressed(const std::vector<ros2::Offer>& offers, const std::string& topic);

/// Why there are no such topics, with those that there are.
Error nothing_published(const CameraTopics& asked, const std::string& name, int domain,
                        const std::vector<ros2::Offer>& offers);

}  // namespace sgs::cameras
