// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "topics.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <string_view>

namespace sgs::cameras {
namespace {

using Offers = std::vector<ros2::Offer>;

constexpr std::string_view kImage = "sensor_msgs/msg/Image";
constexpr std::string_view kPacked = "sensor_msgs/msg/CompressedImage";
constexpr std::string_view kInfo = "sensor_msgs/msg/CameraInfo";
constexpr std::string_view kImu = "sensor_msgs/msg/Imu";

// As drivers of depth cameras name them, behind the camera's name; depth that is registered first.
constexpr std::array<std::string_view, 3> kColor = {"/color/image_raw", "/rgb/image_raw",
                                                    "/rgb/image_rect_color"};
constexpr std::array<std::string_view, 6> kDepth = {"/aligned_depth_to_color/image_raw",
                                                    "/depth_registered/image_raw",
                                                    "/depth_registered/image_rect",
                                                    "/depth_to_rgb/image_raw",
                                                    "/depth/image_raw",
                                                    "/depth/image_rect_raw"};

bool offered(const Offers& offers, const std::string& topic,
             std::initializer_list<std::string_view> types) {
  return std::ranges::any_of(offers, [&](const ros2::Offer& offer) {
    return offer.topic == topic && std::ranges::find(types, offer.type) != types.end();
  });
}

template <class Names>
std::string first_offered(const Offers& offers, const std::string& camera, const Names& names) {
  for (const std::string_view name : names) {
    const std::string topic = camera + std::string(name);
    if (offered(offers, topic, {kImage})) return topic;
  }
  return {};
}

/// The topic of the camera info beside images, as image_transport places it.
std::string info_beside(std::string topic) {
  for (const std::string_view packed : {"/compressedDepth", "/compressed"}) {
    if (topic.ends_with(packed)) topic.resize(topic.size() - packed.size());
  }
  return topic.substr(0, topic.rfind('/')) + "/camera_info";
}

}  // namespace

std::vector<std::string> camera_names(const Offers& offers) {
  std::vector<std::string> names;
  for (const ros2::Offer& offer : offers) {
    for (const std::string_view color : kColor) {
      if (offer.type != kImage || !offer.topic.ends_with(color)) continue;
      const std::string name = offer.topic.substr(0, offer.topic.size() - color.size());
      if (!first_offered(offers, name, kDepth).empty()) names.push_back(name);
    }
  }
  std::ranges::sort(names);
  const auto same = std::ranges::unique(names);
  names.erase(same.begin(), same.end());
  return names;
}

Result<std::optional<CameraTopics>> complete(const CameraTopics& asked, const std::string& name,
                                             const Offers& offers) {
  CameraTopics topics = asked;
  std::string camera = name;
  if ((topics.color.empty() || topics.depth.empty()) && camera.empty()) {
    const auto names = camera_names(offers);
    if (names.empty()) return std::optional<CameraTopics>();
    if (names.size() > 1) {
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("{} cameras are published", names.size()),
                  fmt::format("choose one: camera:ros2:{}", fmt::join(names, "; camera:ros2:")));
    }
    camera = names.front();
  }
  if (topics.color.empty()) topics.color = first_offered(offers, camera, kColor);
  if (topics.depth.empty()) topics.depth = first_offered(offers, camera, kDepth);
  if (topics.color_info.empty()) topics.color_info = info_beside(topics.color);
  if (topics.depth_info.empty()) topics.depth_info = info_beside(topics.depth);
  if (!offered(offers, topics.depth_info, {kInfo})) topics.depth_info.clear();
  if (topics.imu.empty() && !camera.empty()) topics.imu = camera + "/imu";
  if (!offered(offers, topics.imu, {kImu})) topics.imu.clear();
  const bool there = offered(offers, topics.color, {kImage, kPacked}) &&
                     offered(offers, topics.depth, {kImage, kPacked}) &&
                     offered(offers, topics.color_info, {kInfo});
  return there ? std::optional(topics) : std::nullopt;
}

bool is_compressed(const Offers& offers, const std::string& topic) {
  return offered(offers, topic, {kPacked});
}

Error nothing_published(const CameraTopics& asked, const std::string& name, int domain,
                        const Offers& offers) {
  if (offers.empty()) {
    return {
        ErrorCode::kNotFound,
        fmt::format("nobody publishes anything in the ROS 2 domain {}", domain),
        "start the camera's node; both need the same ROS_DOMAIN_ID (or ,domain=N) and a network "
        "that DDS uses (CYCLONEDDS_URI, ROS_LOCALHOST_ONLY)"};
  }
  std::vector<std::string> images, infos;
  for (const ros2::Offer& offer : offers) {
    if (offer.type == kImage || offer.type == kPacked) images.push_back(offer.topic);
    if (offer.type == kInfo) infos.push_back(offer.topic);
  }
  std::vector<std::string> wanted;
  for (const std::string& topic : {asked.color, asked.depth, asked.color_info}) {
    if (!topic.empty()) wanted.push_back(topic);
  }
  if (!name.empty()) wanted.push_back(name);
  const std::string what = wanted.empty()
                               ? "no colour and depth images with a camera info are published"
                               : fmt::format(
                                     "not all of {} is published: colour, depth and a camera info "
                                     "are needed",
                                     fmt::join(wanted, ", "));
  const auto list = [](const std::vector<std::string>& topics) {
    return topics.empty() ? std::string("none") : fmt::format("{}", fmt::join(topics, ", "));
  };
  return {ErrorCode::kNotFound,
          fmt::format("{} in the ROS 2 domain {}; topics with images that are there: {}; with "
                      "camera infos: {}",
                      what, domain, list(images), list(infos)),
          "name them: camera:ros2,color=/TOPIC,depth=/TOPIC,info=/TOPIC"};
}

}  // namespace sgs::cameras
