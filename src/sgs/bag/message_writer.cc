// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/bag/message_writer.h"

#include <array>
#include <cmath>

#include "sgs/bag/wire_writer.h"

namespace sgs::bag {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

/// A type and what it consists of; types it uses follow from the list's order.
struct Definition {
  std::string_view type, ros1, ros2;
};

constexpr std::string_view kPoint = "float64 x\nfloat64 y\nfloat64 z\n";

constexpr std::array kDefinitions = {
    Definition{"std_msgs/Header", "uint32 seq\ntime stamp\nstring frame_id\n",
               "builtin_interfaces/Time stamp\nstring frame_id\n"},
    Definition{"builtin_interfaces/Time", "", "int32 sec\nuint32 nanosec\n"},
    Definition{"geometry_msgs/Point", kPoint, kPoint},
    Definition{"geometry_msgs/Vector3", kPoint, kPoint},
    Definition{"geometry_msgs/Quaternion", "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n",
               "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"},
    Definition{"geometry_msgs/Pose", "Point position\nQuaternion orientation\n",
               "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n"},
    Definition{"geometry_msgs/PoseStamped", "Header header\nPose pose\n",
               "std_msgs/Header header\ngeometry_msgs/Pose pose\n"},
    Definition{"geometry_msgs/Transform", "Vector3 translation\nQuaternion rotation\n",
               "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n"},
    Definition{"geometry_msgs/TransformStamped",
               "Header header\nstring child_frame_id\nTransform transform\n",
               "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform "
               "transform\n"},
    Definition{"tf2_msgs/TFMessage", "geometry_msgs/TransformStamped[] transforms\n",
               "geometry_msgs/TransformStamped[] transforms\n"},
    Definition{"nav_msgs/Path", "Header header\ngeometry_msgs/PoseStamped[] poses\n",
               "std_msgs/Header header\ngeometry_msgs/PoseStamped[] poses\n"},
    Definition{"sensor_msgs/PointField",
               "uint8 INT8=1\nuint8 UINT8=2\nuint8 INT16=3\nuint8 UINT16=4\nuint8 INT32=5\nuint8 "
               "UINT32=6\nuint8 FLOAT32=7\nuint8 FLOAT64=8\nstring name\nuint32 offset\nuint8 "
               "datatype\nuint32 count\n",
               "uint8 INT8=1\nuint8 UINT8=2\nuint8 INT16=3\nuint8 UINT16=4\nuint8 INT32=5\nuint8 "
               "UINT32=6\nuint8 FLOAT32=7\nuint8 FLOAT64=8\nstring name\nuint32 offset\nuint8 "
               "datatype\nuint32 count\n"},
    Definition{"sensor_msgs/PointCloud2",
               "Header header\nuint32 height\nuint32 width\nPointField[] fields\nbool "
               "is_bigendian\nuint32 point_step\nuint32 row_step\nuint8[] data\nbool is_dense\n",
               "std_msgs/Header header\nuint32 height\nuint32 width\nsensor_msgs/PointField[] "
               "fields\nbool is_bigendian\nuint32 point_step\nuint32 row_step\nuint8[] data\nbool "
               "is_dense\n"},
};

/// A type that can be written, the sum of its ROS 1 definition, and all that it consists of.
struct Written {
  std::string_view type, md5;
  std::array<std::string_view, 8> parts;
};

constexpr std::string_view kHeader = "std_msgs/Header", kTime = "builtin_interfaces/Time";

constexpr Written written(WrittenType type) {
  switch (type) {
    case WrittenType::kTransforms:
      return {"tf2_msgs/TFMessage",
              "94810edda583a504dfda3829e70d7eec",
              {"geometry_msgs/TransformStamped", kHeader, kTime, "geometry_msgs/Transform",
               "geometry_msgs/Vector3", "geometry_msgs/Quaternion"}};
    case WrittenType::kPose:
      return {"geometry_msgs/PoseStamped",
              "d3812c3cbc69362b77dc0b19b345f8f5",
              {kHeader, kTime, "geometry_msgs/Pose", "geometry_msgs/Point",
               "geometry_msgs/Quaternion"}};
    case WrittenType::kPath:
      return {"nav_msgs/Path",
              "6227e2b7e9cce15051f669a5e197bbf7",
              {kHeader, kTime, "geometry_msgs/PoseStamped", "geometry_msgs/Pose",
               "geometry_msgs/Point", "geometry_msgs/Quaternion"}};
    case WrittenType::kCloud:
      break;
  }
  return {"sensor_msgs/PointCloud2",
          "1158d486dd51d683ce2f1be655c3c181",
          {kHeader, kTime, "sensor_msgs/PointField"}};
}

std::string_view definition_of(std::string_view type, bool ros2) {
  for (const Definition& definition : kDefinitions) {
    if (definition.type == type) return ros2 ? definition.ros2 : definition.ros1;
  }
  return {};
}

void put_header(WireWriter& out, const Header& header) {
  const std::int64_t seconds = header.stamp_ns / kSecond_ns;
  if (out.encoding() == Encoding::kRos1) {
    out.count(0).number(static_cast<std::uint32_t>(seconds));
  } else {
    out.number(static_cast<std::int32_t>(seconds));
  }
  out.number(static_cast<std::uint32_t>(header.stamp_ns % kSecond_ns)).string(header.frame_id);
}

/// Position or translation, then the quaternion.
void put_rigid(WireWriter& out, const SE3& T) {
  const Eigen::Quaterniond q = T.quaternion();
  for (const double value : {T.t.x(), T.t.y(), T.t.z(), q.x(), q.y(), q.z(), q.w()}) {
    out.number(value);
  }
}

}  // namespace

std::string type_name(WrittenType type, bool ros2) {
  std::string name(written(type).type);
  if (ros2) name.replace(name.find('/'), 1, "/msg/");
  return name;
}

std::string message_definition(WrittenType type, bool ros2) {
  constexpr int kRule = 80;
  const Written message = written(type);
  std::string text(definition_of(message.type, ros2));
  for (const std::string_view part : message.parts) {
    const std::string_view definition = definition_of(part, ros2);
    if (definition.empty()) continue;
    text += fmt::format("\n{}\nMSG: {}\n{}", std::string(kRule, '='), part, definition);
  }
  return text;
}

std::string_view message_md5(WrittenType type) { return written(type).md5; }

std::string write_transforms(std::span<const TransformMessage> transforms, Encoding encoding) {
  WireWriter out(encoding);
  out.count(transforms.size());
  for (const TransformMessage& transform : transforms) {
    put_header(out, transform.header);
    out.string(transform.child);
    put_rigid(out, transform.T_parent_child);
  }
  return out.data();
}

std::string write_pose(const PoseMessage& pose, Encoding encoding) {
  WireWriter out(encoding);
  put_header(out, pose.header);
  put_rigid(out, pose.pose);
  return out.data();
}

std::string write_path(const Header& header, const Trajectory& poses, Encoding encoding) {
  WireWriter out(encoding);
  put_header(out, header);
  out.count(poses.size());
  for (const StampedPose& pose : poses.poses()) {
    put_header(out, {nanoseconds_of(pose.timestamp_s), header.frame_id});
    put_rigid(out, pose.T_world_camera);
  }
  return out.data();
}

std::string write_cloud(const Header& header, std::span<const io::ColoredPoint> points,
                        Encoding encoding) {
  constexpr std::uint8_t kFloat32 = 7;
  constexpr std::uint32_t kPoint_bytes = 16;
  WireWriter out(encoding);
  put_header(out, header);
  out.count(1).count(points.size());
  constexpr std::array<std::string_view, 4> kFields = {"x", "y", "z", "rgb"};
  out.count(kFields.size());
  std::uint32_t offset = 0;
  for (const std::string_view field : kFields) {
    out.string(field).number(offset).number(kFloat32).count(1);
    offset += sizeof(float);
  }
  out.number(std::uint8_t{0}).number(kPoint_bytes).count(kPoint_bytes * points.size());
  // The colour is a number whose bytes are b, g, r, 0: so viewers expect it.
  WireWriter data;
  for (const io::ColoredPoint& point : points) {
    for (int axis = 0; axis < 3; ++axis) data.number(point.position[axis]);
    data.number(
        static_cast<std::uint32_t>(point.color.r << 16 | point.color.g << 8 | point.color.b));
  }
  out.bytes(data.data()).number(std::uint8_t{1});
  return out.data();
}

std::string write_image(const ImageMessage& image, Encoding encoding) {
  WireWriter out(encoding);
  put_header(out, image.header);
  out.number(image.height).number(image.width).string(image.encoding);
  out.number(static_cast<std::uint8_t>(image.big_endian)).number(image.step).bytes(image.data);
  return out.data();
}

std::string write_camera_info(const CameraInfoMessage& info, Encoding encoding) {
  WireWriter out(encoding);
  put_header(out, info.header);
  out.number(info.height).number(info.width).string(info.distortion_model).count(info.D.size());
  for (const double value : info.D) out.number(value);
  for (const double value : info.K) out.number(value);
  for (int i = 0; i < 9; ++i) out.number(i % 4 == 0 ? 1.0 : 0.0);  // R
  for (const double value : info.P) out.number(value);
  for (const std::uint32_t value :
       {info.binning_x, info.binning_y, info.roi_x, info.roi_y, info.roi_height, info.roi_width}) {
    out.number(value);
  }
  out.number(std::uint8_t{0});
  return out.data();
}

std::string write_imu(const ImuMessage& imu, Encoding encoding) {
  constexpr double kNotMeasured = -1;  // in the first place of a covariance
  WireWriter out(encoding);
  put_header(out, imu.header);
  const auto put = [&](std::initializer_list<double> values, bool measured) {
    for (const double value : values) out.number(value);
    for (int i = 0; i < 9; ++i) out.number(i == 0 && !measured ? kNotMeasured : 0.0);
  };
  put({0, 0, 0, 1}, false);
  for (const auto& vector : {imu.angular_velocity_rad_s, imu.acceleration_m_s2}) {
    const Eigen::Vector3d v = vector.value_or(Eigen::Vector3d::Zero());
    put({v.x(), v.y(), v.z()}, vector.has_value());
  }
  return out.data();
}

std::int64_t nanoseconds_of(double seconds) {
  const double whole = std::floor(seconds);
  return static_cast<std::int64_t>(whole) * kSecond_ns +
         std::llround((seconds - whole) * static_cast<double>(kSecond_ns));
}

}  // namespace sgs::bag
