// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sgs/bag/bag.h"
#include "sgs/bag/messages.h"
#include "sgs/geometry/trajectory.h"
#include "sgs/io/ply.h"

namespace sgs::bag {

/// The messages that recordings are exported with.
enum class WrittenType { kTransforms, kPose, kPath, kCloud };

/// "tf2_msgs/TFMessage"; with `ros2` "tf2_msgs/msg/TFMessage".
std::string type_name(WrittenType type, bool ros2);
/// What all parts of the message look like, as bags of ROS 1 or 2 carry it.
std::string message_definition(WrittenType type, bool ros2);
/// The sum of that definition by which ROS 1 knows a type.
std::string_view message_md5(WrittenType type);

/// Each packs one message. Times are seconds on the recording's clock; of a path, each pose has its
/// own.
std::string write_transforms(std::span<const TransformMessage> transforms, Encoding encoding);
std::string write_pose(const PoseMessage& pose, Encoding encoding);
std::string write_path(const Header& header, const Trajectory& poses, Encoding encoding);
/// sensor_msgs/PointCloud2 with x, y, z and rgb, 16 bytes a point.
std::string write_cloud(const Header& header, std::span<const io::ColoredPoint> points,
                        Encoding encoding);

/// What readers of other containers make of their images and samples (Channel::type says which).
std::string write_image(const ImageMessage& image, Encoding encoding);
/// R is the identity.
std::string write_camera_info(const CameraInfoMessage& info, Encoding encoding);
/// Without an orientation; what was not measured is marked so.
std::string write_imu(const ImuMessage& imu, Encoding encoding);

/// The nanoseconds of a time in seconds, as messages hold it.
std::int64_t nanoseconds_of(double seconds);

}  // namespace sgs::bag
