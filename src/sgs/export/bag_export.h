// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>

#include "sgs/bag/bag_writer.h"
#include "sgs/core/error.h"
#include "sgs/map/gaussian.h"

namespace sgs::run {

/// Writes a run as a recording that RViz, Foxglove and ROS read:
///   /tf    the camera in `map` at each of its times, and `map` in `world`, whose z points up if
///          the first picture was level
///   /pose  geometry_msgs/PoseStamped of the camera, one per tracked frame
///   /path  nav_msgs/Path of all of them, at the first time
///   /map   sensor_msgs/PointCloud2, centres of the solid Gaussians, at the first time
/// The camera's frame is the optical one: x right, y down, z forward.
Status export_bag(const std::filesystem::path& run_folder, std::span<const map::Gaussian> gaussians,
                  bag::BagWriter& writer, const std::filesystem::path& file);

}  // namespace sgs::run
