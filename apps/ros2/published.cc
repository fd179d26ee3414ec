// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "ros2/published.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstring>
#include <utility>
#include <vector>

#include "ros2/dds_node.h"
#include "ros2/messages.h"
#include "sgs/bag/message_writer.h"

namespace sgs::ros2 {
namespace {

/// DDS only reads what is written, but its messages have no const texts.
char* text(const std::string& words) { return const_cast<char*>(words.c_str()); }

builtin_interfaces_msg_dds__Time_ time_of(double timestamp_s) {
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  const std::int64_t ns = bag::nanoseconds_of(timestamp_s);
  return {static_cast<std::int32_t>(ns / kSecond_ns), static_cast<std::uint32_t>(ns % kSecond_ns)};
}

std_msgs_msg_dds__Header_ header_of(double timestamp_s, const std::string& frame) {
  return {time_of(timestamp_s), text(frame)};
}

geometry_msgs_msg_dds__Quaternion_ quaternion_of(const SE3& T) {
  const Eigen::Quaterniond q = T.quaternion();
  return {q.x(), q.y(), q.z(), q.w()};
}

geometry_msgs_msg_dds__Pose_ pose_of(const SE3& T) {
  return {{T.t.x(), T.t.y(), T.t.z()}, quaternion_of(T)};
}

geometry_msgs_msg_dds__Transform_ transform_of(const SE3& T) {
  return {{T.t.x(), T.t.y(), T.t.z()}, quaternion_of(T)};
}

/// A sequence that lies in a vector of ours.
template <class Sequence, class Value>
Sequence sequence_of(std::vector<Value>& values) {
  const auto count = static_cast<std::uint32_t>(values.size());
  return {count, count, values.data(), false};
}

class Dds final : public Publisher {
 public:
  Dds(PublishOptions options, std::unique_ptr<DdsNode> node)
      : options_(std::move(options)), node_(std::move(node)) {}

  Status open_writers() {
    const auto on = [&](const char* name) { return options_.prefix + name; };
    const Quality each = {.reliable = true, .depth = 100};
    const Quality newest = {.reliable = true, .latched = true, .depth = 1};
    SGS_ASSIGN_OR_RETURN(tf_, node_->writer(tf2_msgs_msg_dds__TFMessage__desc, "/tf", each));
    SGS_ASSIGN_OR_RETURN(odom_, node_->writer(nav_msgs_msg_dds__Odometry__desc, on("/odom"), each));
    SGS_ASSIGN_OR_RETURN(path_, node_->writer(nav_msgs_msg_dds__Path__desc, on("/path"), newest));
    SGS_ASSIGN_OR_RETURN(
        cloud_, node_->writer(sensor_msgs_msg_dds__PointCloud2__desc, on("/cloud"), newest));
    SGS_ASSIGN_OR_RETURN(grid_,
                         node_->writer(nav_msgs_msg_dds__OccupancyGrid__desc, on("/grid"), newest));
    return {};
  }

  Status publish(const robot::News& news) override {
    return std::visit([this](const auto& one) { return put(one); }, news);
  }

  void drain() override {
    const dds_time_t until = dds_time() + DDS_SECS(2);
    for (const dds_entity_t writer : {tf_, odom_, path_, cloud_, grid_}) {
      dds_wait_for_acks(writer, std::max<dds_duration_t>(0, until - dds_time()));
    }
  }

 private:
  static Status write(dds_entity_t writer, const void* message) {
    const dds_return_t done = dds_write(writer, message);
    // A listener that hangs: what it misses is its own.
    if (done == DDS_RETCODE_OK || done == DDS_RETCODE_TIMEOUT) return {};
    return fail(ErrorCode::kIo, fmt::format("DDS does not publish: {}", dds_strretcode(done)));
  }

  Status put(const robot::PoseNews& news) {
    const robot::Standing& standing = news.standing;
    std::vector<geometry_msgs_msg_dds__TransformStamped_> transforms = {
        {header_of(news.timestamp_s, options_.map_frame), text(options_.odom_frame),
         transform_of(standing.T_map_odom)},
        {header_of(news.timestamp_s, options_.odom_frame), text(options_.camera_frame),
         transform_of(standing.T_odom_camera)}};
    tf2_msgs_msg_dds__TFMessage_ tf{};
    tf.transforms = sequence_of<decltype(tf.transforms)>(transforms);
    SGS_RETURN_IF_ERROR(write(tf_, &tf));
    nav_msgs_msg_dds__Odometry_ odometry{};
    odometry.header = header_of(news.timestamp_s, options_.odom_frame);
    odometry.child_frame_id = text(options_.camera_frame);
    odometry.pose.pose = pose_of(standing.T_odom_camera);
    if (standing.velocity) {
      const Vector6d& v = *standing.velocity;
      odometry.twist.twist.angular = {v[0], v[1], v[2]};
      odometry.twist.twist.linear = {v[3], v[4], v[5]};
    }
    return write(odom_, &odometry);
  }

  Status put(const robot::PathNews& news) {
    std::vector<geometry_msgs_msg_dds__PoseStamped_> poses;
    for (const StampedPose& pose : news.poses.poses()) {
      poses.push_back(
          {header_of(pose.timestamp_s, options_.map_frame), pose_of(pose.T_world_camera)});
    }
    nav_msgs_msg_dds__Path_ path{};
    path.header = header_of(news.timestamp_s, options_.map_frame);
    path.poses = sequence_of<decltype(path.poses)>(poses);
    return write(path_, &path);
  }

  Status put(const robot::CloudNews& news) {
    constexpr std::uint8_t kFloat32 = 7;
    constexpr std::uint32_t kPoint_bytes = 16;
    constexpr std::size_t kColor_at = 12;
    const std::array<std::string, 4> names = {"x", "y", "z", "rgb"};
    std::vector<sensor_msgs_msg_dds__PointField_> fields;
    for (std::uint32_t i = 0; i < names.size(); ++i) {
      fields.push_back({text(names[i]), 4 * i, kFloat32, 1});
    }
    std::vector<std::uint8_t> data(kPoint_bytes * news.points.size());
    std::uint8_t* to = data.data();
    for (const io::ColoredPoint& point : news.points) {
      std::memcpy(to, point.position.data(), kColor_at);
      // A number whose bytes are b, g, r, 0: so viewers expect it.
      to[kColor_at] = point.color.b;
      to[kColor_at + 1] = point.color.g;
      to[kColor_at + 2] = point.color.r;
      to += kPoint_bytes;
    }
    sensor_msgs_msg_dds__PointCloud2_ cloud{};
    cloud.header = header_of(news.timestamp_s, options_.map_frame);
    cloud.height = 1;
    cloud.width = static_cast<std::uint32_t>(news.points.size());
    cloud.fields = sequence_of<decltype(cloud.fields)>(fields);
    cloud.point_step = kPoint_bytes;
    cloud.row_step = kPoint_bytes * cloud.width;
    cloud.data = sequence_of<decltype(cloud.data)>(data);
    cloud.is_dense = true;
    return write(cloud_, &cloud);
  }

  Status put(const robot::GridNews& news) {
    constexpr std::uint8_t kUnknown = 255, kFree = 0, kOccupied = 100;  // -1 in eight bits
    std::vector<std::uint8_t> cells;
    cells.reserve(news.grid.cells.size());
    for (const occupancy::Cell cell : news.grid.cells) {
      cells.push_back(cell == occupancy::Cell::kFree       ? kFree
                      : cell == occupancy::Cell::kOccupied ? kOccupied
                                                           : kUnknown);
    }
    nav_msgs_msg_dds__OccupancyGrid_ grid{};
    grid.header = header_of(news.timestamp_s, options_.map_frame);
    grid.info.map_load_time = grid.header.stamp;
    grid.info.resolution = static_cast<float>(news.grid.resolution_m);
    grid.info.width = static_cast<std::uint32_t>(news.grid.width);
    grid.info.height = static_cast<std::uint32_t>(news.grid.height);
    grid.info.origin = pose_of(
        SE3(Eigen::Matrix3d::Identity(), {news.grid.origin_m.x(), news.grid.origin_m.y(), 0}));
    grid.data = sequence_of<decltype(grid.data)>(cells);
    return write(grid_, &grid);
  }

  PublishOptions options_;
  std::unique_ptr<DdsNode> node_;
  dds_entity_t tf_ = 0, odom_ = 0, path_ = 0, cloud_ = 0, grid_ = 0;
};

}  // namespace

Result<std::unique_ptr<Publisher>> Publisher::open(const PublishOptions& options) {
  SGS_ASSIGN_OR_RETURN(auto node, DdsNode::open(options.domain));
  auto publisher = std::make_unique<Dds>(options, std::move(node));
  SGS_RETURN_IF_ERROR(publisher->open_writers());
  return publisher;
}

}  // namespace sgs::ros2
