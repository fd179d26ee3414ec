// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "ros2/received.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

namespace sgs::ros2 {
namespace {

std::string text_of(const char* text) { return text == nullptr ? "" : text; }

bag::Header header_of(const std_msgs_msg_dds__Header_& header) {
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  bag::Header out{kSecond_ns * header.stamp.sec + header.stamp.nanosec, text_of(header.frame_id)};
  if (out.frame_id.starts_with('/')) out.frame_id.erase(0, 1);
  return out;
}

std::string_view bytes_of(const dds_sequence_octet& data) {
  if (data._buffer == nullptr) return {};
  return {reinterpret_cast<const char*>(data._buffer), data._length};
}

/// Empty where the unit says that it does not measure this.
std::optional<Eigen::Vector3d> measured(const geometry_msgs_msg_dds__Vector3_& vector,
                                        const double (&covariance)[9]) {
  const Eigen::Vector3d v(vector.x, vector.y, vector.z);
  if (covariance[0] == -1 || !v.allFinite()) return {};
  return v;
}

std::optional<SE3> rigid(const geometry_msgs_msg_dds__Transform_& transform) {
  const auto& t = transform.translation;
  const auto& q = transform.rotation;
  const Eigen::Quaterniond turn(q.w, q.x, q.y, q.z);
  const Eigen::Vector3d shift(t.x, t.y, t.z);
  constexpr double kLeastNorm = 1e-3;
  if (!shift.allFinite() || !turn.coeffs().allFinite() || !(turn.norm() > kLeastNorm)) return {};
  return SE3(turn.normalized().toRotationMatrix(), shift);
}

}  // namespace

bag::ImageMessage received(const sensor_msgs_msg_dds__Image_& message) {
  return {
      header_of(message.header), message.height, message.width,         text_of(message.encoding),
      message.is_bigendian != 0, message.step,   bytes_of(message.data)};
}

bag::CompressedImageMessage received(const sensor_msgs_msg_dds__CompressedImage_& message) {
  return {header_of(message.header), text_of(message.format), bytes_of(message.data)};
}

bag::CameraInfoMessage received(const sensor_msgs_msg_dds__CameraInfo_& message) {
  bag::CameraInfoMessage out;
  out.header = header_of(message.header);
  out.height = message.height;
  out.width = message.width;
  out.distortion_model = text_of(message.distortion_model);
  if (message.d._buffer != nullptr) {
    out.D.assign(message.d._buffer, message.d._buffer + message.d._length);
  }
  std::ranges::copy(message.k, out.K.begin());
  std::ranges::copy(message.p, out.P.begin());
  out.binning_x = message.binning_x;
  out.binning_y = message.binning_y;
  out.roi_x = message.roi.x_offset;
  out.roi_y = message.roi.y_offset;
  out.roi_height = message.roi.height;
  out.roi_width = message.roi.width;
  return out;
}

bag::ImuMessage received(const sensor_msgs_msg_dds__Imu_& message) {
  return {header_of(message.header),
          measured(message.angular_velocity, message.angular_velocity_covariance),
          measured(message.linear_acceleration, message.linear_acceleration_covariance)};
}

std::vector<bag::TransformMessage> received(const tf2_msgs_msg_dds__TFMessage_& message) {
  std::vector<bag::TransformMessage> out;
  const auto& all = message.transforms;
  for (std::uint32_t i = 0; all._buffer != nullptr && i < all._length; ++i) {
    const auto& one = all._buffer[i];
    const auto T = rigid(one.transform);
    std::string child = text_of(one.child_frame_id);
    if (child.starts_with('/')) child.erase(0, 1);
    if (T) out.push_back({header_of(one.header), std::move(child), *T});
  }
  return out;
}

}  // namespace sgs::ros2
