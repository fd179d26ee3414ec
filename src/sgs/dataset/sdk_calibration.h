// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sgs/bag/bag.h"
#include "sgs/bag/messages.h"
#include "sgs/core/error.h"
#include "sgs/geometry/se3.h"

namespace sgs::dataset {

/// What SDKs of cameras write into their recordings beside the images.
///
/// RealSense: on topics below /device_D/sensor_S/STREAM_N, as messages of ROS in its bags, as text
/// "key=value;..." (std_msgs/String) in the .db3 files of its later versions. Orbbec (OrbbecSDK
/// v2): images and inertial samples on /cam/sensor_S/frameType_T, a message of its own for each of
/// them on /cam/streamProfileType_T, and its settings on /cam/property.

/// Whether an image topic is one of these: frame names and conventions of ROS mean nothing there.
bool is_sdk_topic(const std::string& image_topic);

/// "/device_0/sensor_1/Color_0" of an image topic of RealSense's SDK; empty for other topics.
std::string sdk_stream(const std::string& topic);

/// The channel with the calibration of an image topic of an SDK, whatever its type.
std::optional<std::size_t> sdk_info_channel(const bag::Bag& bag, const std::string& image_topic);

/// Reads a calibration that one of these channels, or sensor_msgs/CameraInfo, holds.
Result<bag::CameraInfoMessage> read_any_camera_info(const bag::Message& message,
                                                    const bag::Channel& channel);

/// T_color_depth of two image topics of an SDK, and the topic that says it; empty where the
/// recording has none.
struct SdkExtrinsics {
  SE3 T_color_depth;
  std::string topic;
};
Result<std::optional<SdkExtrinsics>> sdk_extrinsics(const bag::Bag& bag,
                                                    const std::string& color_topic,
                                                    const std::string& depth_topic);

/// From the axes of an accelerometer on a topic of Orbbec's SDK to those of the colour camera;
/// empty where the recording does not say them.
std::optional<Eigen::Matrix3d> sdk_imu_rotation(const bag::Bag& bag, const std::string& imu_topic);

/// The depth's unit as raw units per metre; empty where the recording does not say it. A unit that
/// is none is an error.
struct SdkUnit {
  double units_per_metre = 0;
  std::string topic;
};
Result<std::optional<SdkUnit>> sdk_depth_unit(const bag::Bag& bag, const std::string& depth_topic);

}  // namespace sgs::dataset
