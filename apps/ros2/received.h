// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "ros2/messages.h"
#include "sgs/bag/messages.h"

// Messages that came over DDS, as those of recordings: what they mean is read by the same code.
namespace sgs::ros2 {

/// Views of the message's bytes, which must stay.
bag::ImageMessage received(const sensor_msgs_msg_dds__Image_& message);
bag::CompressedImageMessage received(const sensor_msgs_msg_dds__CompressedImage_& message);

bag::CameraInfoMessage received(const sensor_msgs_msg_dds__CameraInfo_& message);
/// What the unit does not measure (a covariance that begins with -1) and NaN are left out.
bag::ImuMessage received(const sensor_msgs_msg_dds__Imu_& message);
/// Transforms that are no rigid ones are left out.
std::vector<bag::TransformMessage> received(const tf2_msgs_msg_dds__TFMessage_& message);

}  // namespace sgs::ros2
