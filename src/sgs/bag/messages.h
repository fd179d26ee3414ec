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
  std::array<double, 9> K{};   ///< of the whole picture, row by row; all 0 = not calibrated
  std::array<double, 12> P{};  ///< of the rectified picture, row by row
  /// Pixels of the whole picture that became one, across and down; 0 = 1.
  std::uint32_t binning_x = 0, binning_y = 0;
  /// The part of the whole picture that was read out, before binning; empty = all of it.
  std::uint32_t roi_x = 0, roi_y = 0, roi_height = 0, roi_width = 0;
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

class Wire;
/// Takes a header off the front of a message.
Header header_of(Wire& wire);

/// Each understands the bytes of one message. Errors (kInvalidFormat) say what is wrong, but not
/// which file it is in.
Result<Header> read_header(const Message& message, Encoding encoding);
Result<ImageMessage> read_image(const Message& message, Encoding encoding);
Result<CompressedImageMessage> read_compressed_image(const Message& message, Encoding encoding);
Result<CameraInfoMessage> read_camera_info(const Message& message, Encoding encoding);
/// tf/tfMessage and tf2_msgs/TFMessage. As tf2 does it, a transform that is no rigid one (NaN, a
/// quaternion of zeros) costs itself, not its neighbours.
struct TransformMessages {
  std::vector<TransformMessage> transforms;
  std::vector<std::string> unusable;  ///< child frames of those that were left out
};
Result<TransformMessages> read_transforms(const Message& message, Encoding encoding);
Result<ImuMessage> read_imu(const Message& message, Encoding encoding);
Result<PoseMessage> read_pose(const Message& message, Encoding encoding);
Result<PoseMessage> read_odometry(const Message& message, Encoding encoding);
/// geometry_msgs/Transform, as RealSense's SDK writes extrinsics.
Result<SE3> read_plain_transform(const Message& message, Encoding encoding);
/// Extrinsics of realsense2_camera (rotation by columns) and orbbec_camera (by rows), with or
/// without a header: depth to colour.
enum class RotationOrder { kColumns, kRows };
Result<SE3> read_extrinsics(const Message& message, Encoding encoding, RotationOrder order);
/// A transform of twelve numbers: a rotation, then metres; kInvalidFormat where it is no rotation.
Result<SE3> rigid_from_numbers(const std::array<double, 12>& numbers, RotationOrder order);
/// std_msgs/Float32.
Result<float> read_float(const Message& message, Encoding encoding);
/// std_msgs/String.
Result<std::string> read_string(const Message& message, Encoding encoding);

}  // namespace sgs::bag
