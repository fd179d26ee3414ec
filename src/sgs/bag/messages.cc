// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/bag/messages.h"

#include "sgs/bag/wire.h"

namespace sgs::bag {
namespace {

constexpr std::int64_t kNanoseconds = 1'000'000'000;

tl::unexpected<Error> unreadable(std::string_view type) {
  return fail(ErrorCode::kInvalidFormat, fmt::format("a message is no {}", type),
              "the recording is damaged, or its message definitions are others");
}

std::string frame_name(std::string name) {
  if (name.starts_with('/')) name.erase(0, 1);
  return name;
}

Eigen::Vector3d vector_of(Wire& wire) {
  Eigen::Vector3d v;
  for (int i = 0; i < 3; ++i) v[i] = wire.number<double>();
  return v;
}

/// A vector and the covariance behind it, whose first entry is -1 where nothing is measured.
std::optional<Eigen::Vector3d> measured_vector_of(Wire& wire) {
  const Eigen::Vector3d v = vector_of(wire);
  const double first = wire.number<double>();
  for (int i = 1; i < 9; ++i) wire.number<double>();
  if (first == -1 || !v.allFinite()) return std::nullopt;
  return v;
}

/// Translation and quaternion xyzw; false where that is no rigid transform.
bool rigid_of(Wire& wire, SE3& T) {
  const Eigen::Vector3d t = vector_of(wire);
  Eigen::Vector4d q;
  for (int i = 0; i < 4; ++i) q[i] = wire.number<double>();
  constexpr double kUnitTolerance = 0.01;
  if (!wire.ok() || !t.allFinite() || !(std::abs(q.norm() - 1) < kUnitTolerance)) return false;
  T = SE3(Eigen::Quaterniond(q[3], q[0], q[1], q[2]), t);
  return true;
}

}  // namespace

Header header_of(Wire& wire) {
  if (wire.encoding() == Encoding::kRos1) wire.count();  // sequence number
  const std::int64_t seconds = wire.encoding() == Encoding::kRos1
                                   ? std::int64_t{wire.number<std::uint32_t>()}
                                   : std::int64_t{wire.number<std::int32_t>()};
  const std::int64_t nanoseconds = wire.number<std::uint32_t>();
  return {seconds * kNanoseconds + nanoseconds, frame_name(wire.string())};
}

Result<Header> read_header(const Message& message, Encoding encoding) {
  Wire wire(message.data, encoding);
  Header header = header_of(wire);
  if (!wire.ok()) return unreadable("message with a header");
  return header;
}

Result<ImageMessage> read_image(const Message& message, Encoding encoding) {
  Wire wire(message.data, encoding);
  ImageMessage image;
  image.header = header_of(wire);
  image.height = wire.number<std::uint32_t>();
  image.width = wire.number<std::uint32_t>();
  image.encoding = wire.string();
  image.big_endian = wire.number<std::uint8_t>() != 0;
  image.step = wire.number<std::uint32_t>();
  image.data = wire.bytes();
  if (!wire.ok()) return unreadable("sensor_msgs/Image");
  return image;
}

Result<CompressedImageMessage> read_compressed_image(const Message& message, Encoding encoding) {
  Wire wire(message.data, encoding);
  CompressedImageMessage image;
  image.header = header_of(wire);
  image.format = wire.string();
  image.data = wire.bytes();
  if (!wire.ok()) return unreadable("sensor_msgs/CompressedImage");
  return image;
}

Result<CameraInfoMessage> read_camera_info(const Message& message, Encoding encoding) {
  constexpr std::uint32_t kMostCoefficients = 64;
  Wire wire(message.data, encoding);
  CameraInfoMessage info;
  info.header = header_of(wire);
  info.height = wire.number<std::uint32_t>();
  info.width = wire.number<std::uint32_t>();
  info.distortion_model = wire.string();
  const std::uint32_t coefficients = wire.count();
  if (!wire.ok() || coefficients > kMostCoefficients) return unreadable("sensor_msgs/CameraInfo");
  for (std::uint32_t i = 0; i < coefficients; ++i) info.D.push_back(wire.number<double>());
  for (double& value : info.K) value = wire.number<double>();
  for (int i = 0; i < 9; ++i) wire.number<double>();  // R
  for (double& value : info.P) value = wire.number<double>();
  for (std::uint32_t* value : {&info.binning_x, &info.binning_y, &info.roi_x, &info.roi_y,
                               &info.roi_height, &info.roi_width}) {
    *value = wire.number<std::uint32_t>();
  }
  if (!wire.ok()) return unreadable("sensor_msgs/CameraInfo");
  return info;
}

Result<TransformMessages> read_transforms(const Message& message, Encoding encoding) {
  Wire wire(message.data, encoding);
  TransformMessages out;
  const std::uint32_t count = wire.count();
  for (std::uint32_t i = 0; i < count && wire.ok(); ++i) {
    TransformMessage transform;
    transform.header = header_of(wire);
    transform.child = frame_name(wire.string());
    const bool rigid = rigid_of(wire, transform.T_parent_child);
    if (rigid) {
      out.transforms.push_back(std::move(transform));
    } else if (wire.ok()) {
      out.unusable.push_back(std::move(transform.child));
    }
  }
  if (!wire.ok()) return unreadable("tf2_msgs/TFMessage");
  return out;
}

Result<ImuMessage> read_imu(const Message& message, Encoding encoding) {
  Wire wire(message.data, encoding);
  ImuMessage imu;
  imu.header = header_of(wire);
  for (int i = 0; i < 4 + 9; ++i) wire.number<double>();  // orientation and its covariance
  imu.angular_velocity_rad_s = measured_vector_of(wire);
  imu.acceleration_m_s2 = measured_vector_of(wire);
  if (!wire.ok()) return unreadable("sensor_msgs/Imu");
  return imu;
}

Result<PoseMessage> read_pose(const Message& message, Encoding encoding) {
  Wire wire(message.data, encoding);
  PoseMessage pose;
  pose.header = header_of(wire);
  if (!rigid_of(wire, pose.pose)) return unreadable("geometry_msgs/PoseStamped");
  return pose;
}

Result<PoseMessage> read_odometry(const Message& message, Encoding encoding) {
  Wire wire(message.data, encoding);
  PoseMessage pose;
  pose.header = header_of(wire);
  pose.child = frame_name(wire.string());
  if (!rigid_of(wire, pose.pose)) return unreadable("nav_msgs/Odometry");
  return pose;
}

Result<SE3> read_plain_transform(const Message& message, Encoding encoding) {
  Wire wire(message.data, encoding);
  SE3 T;
  if (!rigid_of(wire, T)) return unreadable("geometry_msgs/Transform");
  return T;
}

Result<SE3> rigid_from_numbers(const std::array<double, 12>& numbers, RotationOrder order) {
  Eigen::Matrix3d R;
  for (int i = 0; i < 9; ++i) {
    const int slow = i / 3, fast = i % 3;
    const double value = numbers[static_cast<std::size_t>(i)];
    (order == RotationOrder::kColumns ? R(fast, slow) : R(slow, fast)) = value;
  }
  const Eigen::Vector3d t(numbers[9], numbers[10], numbers[11]);
  constexpr double kOrthonormalTolerance = 1e-3;
  const bool rotation =
      (R.transpose() * R).isIdentity(kOrthonormalTolerance) && R.determinant() > 0;
  if (!t.allFinite() || !rotation) return unreadable("rigid transform");
  return SE3(R, t).normalized();
}

Result<SE3> read_extrinsics(const Message& message, Encoding encoding, RotationOrder order) {
  Wire wire(message.data, encoding);
  std::array<double, 12> numbers{};
  if (wire.ok() && wire.left() != sizeof(numbers)) header_of(wire);
  for (double& number : numbers) number = wire.number<double>();
  if (!wire.ok()) return unreadable("camera's Extrinsics");
  return rigid_from_numbers(numbers, order);
}

Result<float> read_float(const Message& message, Encoding encoding) {
  Wire wire(message.data, encoding);
  const float value = wire.number<float>();
  if (!wire.ok()) return unreadable("std_msgs/Float32");
  return value;
}

Result<std::string> read_string(const Message& message, Encoding encoding) {
  Wire wire(message.data, encoding);
  std::string value = wire.string();
  if (!wire.ok()) return unreadable("std_msgs/String");
  return value;
}

}  // namespace sgs::bag
