// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <optional>

#include "sgs/bag/messages.h"
#include "sgs/dataset/bags/bag_time.h"
#include "sgs/dataset/bags/bag_topics.h"
#include "sgs/dataset/bags/bag_transforms.h"
#include "sgs/dataset/imu.h"
#include "sgs/dataset/sdk_calibration.h"

namespace sgs::dataset {
namespace {

constexpr const char* kImuType = "sensor_msgs/Imu";

/// A topic that measures accelerations.
struct ImuTopic {
  std::size_t channel = 0;
  std::optional<Eigen::Matrix3d> R_camera_imu;
};

/// The first message that can be read; empty where the topic measures no acceleration.
std::optional<bag::ImuMessage> first_measurement(const bag::Bag& bag, std::size_t channel) {
  const auto message = first_message(bag, channel);
  if (!message || !*message) return std::nullopt;
  auto imu = bag::read_imu(**message, bag.channels()[channel].encoding);
  // Gyroscopes on topics of their own leave the other half at zero.
  const bool measures = imu && imu->acceleration_m_s2 && !imu->acceleration_m_s2->isZero();
  return measures ? std::optional(std::move(*imu)) : std::nullopt;
}

std::optional<ImuTopic> choose_topic(const bag::Bag& bag, const std::string& camera_frame) {
  std::optional<TransformTree> tree;
  std::optional<ImuTopic> chosen;
  for (std::size_t i = 0; i < bag.channels().size(); ++i) {
    const bag::Channel& channel = bag.channels()[i];
    if (channel.type != kImuType || channel.encoding == bag::Encoding::kOther) continue;
    const auto first = first_measurement(bag, i);
    if (!first) continue;
    if (!tree) {
      auto read = TransformTree::read(bag, false);
      tree = read ? std::move(*read) : TransformTree();
    }
    // SDKs give all their messages the same frame name, or none: that says nothing.
    if (is_sdk_topic(channel.topic)) {
      if (const auto R = sdk_imu_rotation(bag, channel.topic)) return ImuTopic{i, R};
    } else if (const auto joined = tree->fixed(camera_frame, first->header.frame_id)) {
      return ImuTopic{i, joined->R};
    }
    if (!chosen) chosen = ImuTopic{i, std::nullopt};
  }
  return chosen;
}

}  // namespace

ImuRecording read_bag_imu(const bag::Bag& bag, const std::string& camera_frame) {
  ImuRecording imu;
  const auto topic = choose_topic(bag, camera_frame);
  if (!topic) return imu;
  const bag::Channel& channel = bag.channels()[topic->channel];
  imu.source = channel.topic;
  imu.R_camera_imu = topic->R_camera_imu;
  const auto cursor = bag.read({topic->channel});
  std::size_t unreadable = 0;
  while (true) {
    const auto message = cursor->next();
    if (message && !*message) break;
    const auto read = message ? bag::read_imu(**message, channel.encoding)
                              : Result<bag::ImuMessage>(tl::unexpected(message.error()));
    if (!read) {
      if (++unreadable == 1) {
        imu.warnings.push_back(fmt::format("{}: {}", channel.topic, read.error().message));
      }
      continue;
    }
    if (!read->acceleration_m_s2) continue;
    const std::int64_t stamp_ns = read->header.stamp_ns;
    const std::int64_t time_ns = stamp_ns != 0 ? stamp_ns : (*message)->record_time_ns;
    imu.samples.push_back(
        {seconds_of(time_ns), *read->acceleration_m_s2, read->angular_velocity_rad_s});
  }
  if (unreadable > 1) {
    imu.warnings.push_back(
        fmt::format("{}: {} messages in all cannot be read", channel.topic, unreadable));
  }
  return imu;
}

}  // namespace sgs::dataset
