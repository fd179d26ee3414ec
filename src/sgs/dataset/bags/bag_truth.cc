// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/bags/bag_truth.h"

#include <vector>

#include "sgs/bag/messages.h"
#include "sgs/dataset/bags/bag_time.h"
#include "sgs/dataset/bags/bag_topics.h"
#include "sgs/dataset/bags/bag_transforms.h"

namespace sgs::dataset {
namespace {

constexpr const char* kPoseType = "geometry_msgs/PoseStamped";
constexpr const char* kOdometryType = "nav_msgs/Odometry";

std::string pose_topics(const bag::Bag& bag) {
  std::string text;
  for (const bag::Channel& channel : bag.channels()) {
    if (channel.type != kPoseType && channel.type != kOdometryType) continue;
    text += fmt::format("{}{}", text.empty() ? "" : ", ", channel.topic);
  }
  return text.empty() ? "none" : text;
}

std::optional<std::size_t> topic_named_truth(const bag::Bag& bag) {
  std::optional<std::size_t> found;
  for (std::size_t i = 0; i < bag.channels().size(); ++i) {
    const bag::Channel& channel = bag.channels()[i];
    const bool truth = channel.topic.find("groundtruth") != std::string::npos ||
                       channel.topic.find("ground_truth") != std::string::npos;
    if (!truth || (channel.type != kPoseType && channel.type != kOdometryType)) continue;
    if (found) return std::nullopt;
    found = i;
  }
  return found;
}

/// T_body_camera, as far as tf knows it.
SE3 camera_in(const bag::Bag& bag, const std::string& body, const std::string& camera_frame) {
  if (body.empty() || body == camera_frame) return {};
  const auto tree = TransformTree::read(bag, false);
  return tree ? tree->fixed(body, camera_frame).value_or(SE3{}) : SE3{};
}

BagTruth read_poses(const bag::Bag& bag, std::size_t channel, const std::string& camera_frame) {
  constexpr std::int64_t kSetBack_ns = 1'000'000'000;
  const bag::Channel& about = bag.channels()[channel];
  const bool odometry = about.type == kOdometryType;
  const auto cursor = bag.read({channel});
  BagTruth truth;
  std::vector<StampedPose> poses;
  std::optional<SE3> T_body_camera;
  std::size_t unusable = 0;
  Error first_error;
  std::optional<std::int64_t> last_ns;
  while (true) {
    const auto message = cursor->next();
    if (message && !*message) break;
    const auto pose = !message   ? Result<bag::PoseMessage>(tl::unexpected(message.error()))
                      : odometry ? bag::read_odometry(**message, about.encoding)
                                 : bag::read_pose(**message, about.encoding);
    if (!pose) {
      if (unusable++ == 0) first_error = pose.error();
      continue;
    }
    const std::int64_t time_ns = pose->header.stamp_ns;
    if (last_ns && time_ns < *last_ns - kSetBack_ns) {
      truth.warnings.push_back(
          fmt::format("{}: the clock was set back by {:.3f} s; ground truth ends there",
                      about.topic, 1e-9 * static_cast<double>(*last_ns - time_ns)));
      break;
    }
    last_ns = time_ns;
    if (!T_body_camera) T_body_camera = camera_in(bag, pose->child, camera_frame);
    poses.push_back({seconds_of(time_ns), pose->pose * *T_body_camera});
  }
  if (unusable > 0) {
    truth.warnings.push_back(
        fmt::format("{}: {} messages are no poses and were left out; the "
                    "first: {}",
                    about.topic, unusable, first_error.message));
  }
  truth.poses = Trajectory(std::move(poses));
  return truth;
}

}  // namespace

Result<BagTruth> read_bag_truth(const bag::Bag& bag, const std::string& option,
                                const std::string& camera_frame) {
  constexpr double kLargestGap_s = 0.1;
  if (option.empty()) {
    const auto channel = topic_named_truth(bag);
    return channel ? read_poses(bag, *channel, camera_frame) : BagTruth{};
  }
  if (const auto colon = option.find(':'); colon != std::string::npos) {
    SGS_ASSIGN_OR_RETURN(const auto tree, TransformTree::read(bag, true));
    const auto frame = [](std::string name) {
      return name.starts_with('/') ? name.substr(1) : name;
    };
    auto truth =
        tree.moving(frame(option.substr(0, colon)), frame(option.substr(colon + 1)), kLargestGap_s);
    if (!truth.empty()) return BagTruth{std::move(truth), tree.warnings()};
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("--truth-topic {}: tf does not join these frames; it has {}", option,
                            tree.empty() ? "none" : tree.frames()),
                "name two of them that tf joins, or a topic of poses, or leave the option out");
  }
  for (const char* type : {kPoseType, kOdometryType}) {
    if (const auto channel = find_channel(bag, option, {type})) {
      return read_poses(bag, *channel, camera_frame);
    }
  }
  return fail(ErrorCode::kInvalidArgument,
              fmt::format("--truth-topic '{}' is no topic of {} or {}; there are: {}", option,
                          kPoseType, kOdometryType, pose_topics(bag)),
              "name one, or two frames of tf as WORLD:CAMERA");
}

}  // namespace sgs::dataset
