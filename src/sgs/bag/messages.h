// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sgs/bag/bag.h"
#include "sgs/core/error.h"
#include "sgs/geometry/se3.h"

namespace sgs::bag {

/// std_msgs/Header.
struct Header {
  std::int64_t stamp_ns = 0;
  std::string frame_id;  ///< without a leading slash, which old versions wrote
};

/// sensor_msgs/Image. `data` points into the message.
struct ImageMessage {
  Header header;
  std::uint32_t height = 0, width = 0;
  std::string encoding;
  bool big_endian = false;
  std::uint32_t step = 0;  ///< bytes of a row
  std::string_view data;
};

/// sensor_msgs/CompressedImage. `data` points into the message.
struct CompressedImageMessage {
  Header header;
  std::string format;
  std::string_view data;
};

/// sensor_msgs/CameraInfo as far as a monocular camera needs it.
struct CameraInfoMessage {
  Header header;
  std::uint32_t height = 0, width = 0;
  std::string distortion_model;
  std::vector<double> D;
  std::array<double, 9> K{};   ///< of the picture as delivered, row by row
  std::array<double, 12> P{};  ///< of the rectified picture, row by row
};

/// One of tf2_msgs/TFMessage.
struct TransformMessage {
  Header header;  ///< frame_id is the parent
  std::string child;
  SE3 T_parent_child;
};

/// geometry_msgs/PoseStamped or nav_msgs/Odometry.
struct PoseMessage {
  Header header;
  std::string child;  ///< odometry only
  SE3 pose;
};

/// sensor_msgs/Imu without its covariances. What the unit does not measure is empty.
struct ImuMessage {
  Header header;
  std::optional<Eigen::Vector3d> angular_velocity_rad_s;
  std::optional<Eigen::Vector3d> acceleration_m_s2;
};

/// Each understands the bytes of one message. Errors (kInvalidFormat) say what is wrong, but not
/// which file it is in.
Result<Header> read_header(const Message& message, Encoding encoding);
Result<ImageMessage> read_image(const Message& message, Encoding encoding);
Result<CompressedImageMessage> read_compressed_image(const Message& message, Encoding encoding);
Result<CameraInfoMessage> read_camera_info(const Message& message, Encoding encoding);
/// tf/tfMessage and tf2_msgs/TFMessage.
Result<std::vector<TransformMessage>> read_transforms(const Message& message, Encoding encoding);
Result<ImuMessage> read_imu(const Message& message, Encoding encoding);
Result<PoseMessage> read_pose(const Message& message, Encoding encoding);
Result<PoseMessage> read_odometry(const Message& message, Encoding encoding);
/// geometry_msgs/Transform, as RealSense's SDK writes extrinsics.
Result<SE3> read_plain_transform(const Message& message, Encoding encoding);
/// realsense2_camera/Extrinsics, with or without a header: depth to colour, rotation by columns.
Result<SE3> read_extrinsics(const Message& message, Encoding encoding);
/// std_msgs/Float32.
Result<float> read_float(const Message& message, Encoding encoding);

}  // namespace sgs::bag
