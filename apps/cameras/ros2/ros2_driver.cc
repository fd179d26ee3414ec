// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "ros2_driver.h"

#include <dds/version.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <deque>
#include <exception>
#include <set>
#include <thread>
#include <utility>

#include "common/calibration.h"
#include "common/family_driver.h"
#include "pictures.h"
#include "ros2/frame_tree.h"
#include "ros2/received.h"
#include "sgs/dataset/bags/bag_lens.h"
#include "sgs/dataset/bags/bag_time.h"

namespace sgs::cameras {
namespace {

using capture::CameraImage;
using capture::CameraMode;
using capture::CameraSink;
using Clock = std::chrono::steady_clock;

/// Images of one kind.
struct Side {
  CameraImage::Kind kind = CameraImage::Kind::kColor;
  std::string topic;
  bool packed = false;
  dds_entity_t reader = 0;
  std::optional<Picture> first;  ///< without its bytes
};

/// Whether a driver names depth so that lies on colour.
bool named_registered(const std::string& topic) {
  constexpr std::array<std::string_view, 3> kNames = {"aligned_depth_to_color", "depth_registered",
                                                      "depth_to_rgb"};
  return std::ranges::any_of(kNames,
                             [&](auto name) { return topic.find(name) != std::string::npos; });
}

class Ros2Camera final : public FamilyDriver {
 public:
  explicit Ros2Camera(std::shared_ptr<const Ros2Options> options) : options_(std::move(options)) {}
  ~Ros2Camera() override { Ros2Camera::stop(); }

  Result<stream::Hello> start(const CameraMode& mode, CameraSink& sink) override {
    sink_ = &sink;
    until_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                std::chrono::duration<double>(options_->wait_s));
    SGS_ASSIGN_OR_RETURN(node_, ros2::DdsNode::open(options_->domain));
    SGS_RETURN_IF_ERROR(find_topics(mode.serial));
    SGS_RETURN_IF_ERROR(open_readers(mode));
    auto hello = greeting();
    if (!hello) {
      stop();
      return hello;
    }
    listener_ = std::jthread([this](const std::stop_token& stop) { listen(stop); });
    return hello;
  }

  bool present() override {
    return std::ranges::all_of(sides_, [](const Side& side) {
      return dds_get_matched_publications(side.reader, nullptr, 0) > 0;
    });
  }
  Error gone() const override {
    return {ErrorCode::kIo,
            fmt::format("nobody publishes {} and {} any more", color().topic, depth().topic),
            "start the camera's node again"};
  }
  Error silent(double seconds) const override {
    return {ErrorCode::kIo,
            fmt::format("no image has come on {} and {} for {:.0f} s", color().topic, depth().topic,
                        seconds),
            "is the camera's node stopped? Large images get lost on their way, too, where "
            "net.core.rmem_max is small"};
  }
  Status lock_exposure() override {
    return fail(ErrorCode::kUnsupported, "the exposure of a camera behind ROS is its node's",
                "set its parameters there");
  }
  void stop() override {
    listener_.request_stop();
    if (listener_.joinable()) listener_.join();
    node_.reset();
  }

 private:
  Status list_into(stream::CameraFamily& family) override {
    family.library = fmt::format("Cyclone DDS {}", DDS_VERSION);
    SGS_ASSIGN_OR_RETURN(const auto node, ros2::DdsNode::open(options_->domain));
    const auto offers = discovered(*node);
    for (const std::string& name : camera_names(offers)) {
      family.devices.push_back(
          {"ROS 2 topics below " + name, name, "", fmt::format("domain {}", node->domain())});
    }
    if (family.devices.empty()) {
      return tl::unexpected<Error>(nothing_published(options_->topics, "", node->domain(), offers));
    }
    return {};
  }

  /// What is published once nothing more seems to come: others are found one after the other.
  static std::vector<ros2::Offer> discovered(const ros2::DdsNode& node) {
    constexpr std::chrono::milliseconds kMost(3500), kNobody(1500), kQuiet(500), kStep(50);
    const auto begin = Clock::now();
    auto offers = node.offers();
    for (auto changed = begin; Clock::now() - begin < kMost;) {
      std::this_thread::sleep_for(kStep);
      auto now = node.offers();
      if (now != offers) changed = Clock::now();
      offers = std::move(now);
      if (!camera_names(offers).empty() && Clock::now() - changed > kQuiet) break;
      // Every node of ROS publishes something.
      if (offers.empty() && Clock::now() - begin > kNobody) break;
    }
    return offers;
  }

  Status find_topics(const std::string& name) {
    while (true) {
      const auto offers = node_->offers();
      SGS_ASSIGN_OR_RETURN(const auto found, complete(options_->topics, name, offers));
      if (found) {
        topics_ = *found;
        color().topic = topics_.color;
        depth().topic = topics_.depth;
        depth().kind = CameraImage::Kind::kDepth;
        for (Side& side : sides_) side.packed = is_compressed(offers, side.topic);
        return {};
      }
      if (Clock::now() > until_) {
        return tl::unexpected<Error>(
            nothing_published(options_->topics, name, node_->domain(), offers));
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
  }

  Result<dds_entity_t> opened(const dds_topic_descriptor_t& type, const std::string& topic,
                              const ros2::Quality& quality) {
    SGS_ASSIGN_OR_RETURN(const dds_entity_t reader, node_->reader(type, topic, quality));
    dds_set_status_mask(reader, DDS_DATA_AVAILABLE_STATUS);
    dds_waitset_attach(waiting_, reader, 0);
    return reader;
  }

  Status open_readers(const CameraMode& mode) {
    waiting_ = dds_create_waitset(node_->participant());
    // Who waits for each frame has the publisher wait, too.
    const ros2::Quality images = {.reliable = mode.every_frame, .depth = mode.every_frame ? 0 : 10};
    for (Side& side : sides_) {
      const auto& type = side.packed ? sensor_msgs_msg_dds__CompressedImage__desc
                                     : sensor_msgs_msg_dds__Image__desc;
      SGS_ASSIGN_OR_RETURN(side.reader, opened(type, side.topic, images));
    }
    const auto& info = sensor_msgs_msg_dds__CameraInfo__desc;
    SGS_ASSIGN_OR_RETURN(color_info_reader_, opened(info, topics_.color_info, {}));
    if (!topics_.depth_info.empty()) {
      SGS_ASSIGN_OR_RETURN(depth_info_reader_, opened(info, topics_.depth_info, {}));
    }
    if (mode.imu && !topics_.imu.empty()) {
      constexpr int kSamples = 1000;
      SGS_ASSIGN_OR_RETURN(
          imu_reader_, opened(sensor_msgs_msg_dds__Imu__desc, topics_.imu, {.depth = kSamples}));
    }
    SGS_ASSIGN_OR_RETURN(tf_reader_, opened(tf2_msgs_msg_dds__TFMessage__desc, "/tf_static",
                                            {.reliable = true, .latched = true, .depth = 100}));
    return {};
  }

  /// Waits until something has come, a tenth of a second at most, and takes all of it.
  void take() {
    constexpr dds_duration_t kWait = DDS_MSECS(100);
    dds_attach_t which = 0;
    dds_waitset_wait(waiting_, &which, 1, kWait);
    using Info = sensor_msgs_msg_dds__CameraInfo_;
    ros2::take_all<Info>(color_info_reader_, [&](const Info& message) {
      if (!color_info_) color_info_ = ros2::received(message);
    });
    if (depth_info_reader_ > 0) {
      ros2::take_all<Info>(depth_info_reader_, [&](const Info& message) {
        if (!depth_info_) depth_info_ = ros2::received(message);
      });
    }
    using Transforms = tf2_msgs_msg_dds__TFMessage_;
    ros2::take_all<Transforms>(
        tf_reader_, [&](const Transforms& message) { frames_.add(ros2::received(message)); });
    using Imu = sensor_msgs_msg_dds__Imu_;
    if (imu_reader_ > 0) {
      ros2::take_all<Imu>(imu_reader_, [&](const Imu& message) { take(ros2::received(message)); });
    }
    for (Side& side : sides_) take_images(side);
  }

  void take(const bag::ImuMessage& message) {
    imu_frame_ = message.header.frame_id;
    if (!greeted_) {  // those that come before the greeting belong to the first images
      constexpr std::size_t kMostEarly = 1000;
      early_samples_.push_back(message);
      if (early_samples_.size() > kMostEarly) early_samples_.pop_front();
      return;
    }
    if (!T_color_imu_) return;
    stream::InertialSample sample;
    sample.timestamp_s = dataset::seconds_of(message.header.stamp_ns);
    const auto put = [](const std::optional<Eigen::Vector3d>& from, std::array<double, 3>& to) {
      if (from) std::copy_n(from->data(), to.size(), to.begin());
    };
    put(message.angular_velocity_rad_s, sample.angular_velocity_rad_s);
    put(message.acceleration_m_s2, sample.acceleration_m_s2);
    sink_->take(sample, 0);
  }

  void take_images(Side& side) {
    constexpr int kImages = 10;  // then the other side's turn comes
    const bool is_color = side.kind == CameraImage::Kind::kColor;
    const auto take_one = [&](const auto& message) {
      const auto raw = ros2::received(message);
      auto picture = is_color ? color_of(raw) : depth_of(raw);
      if (picture) {
        take(side, std::move(*picture));
      } else {
        trouble(side, picture.error());
      }
    };
    if (side.packed) {
      ros2::take_all<sensor_msgs_msg_dds__CompressedImage_>(side.reader, take_one, kImages);
    } else {
      ros2::take_all<sensor_msgs_msg_dds__Image_>(side.reader, take_one, kImages);
    }
  }

  void take(Side& side, Picture picture) {
    CameraImage image;
    image.kind = side.kind;
    image.stamp_s = dataset::seconds_of(picture.header.stamp_ns);
    image.bytes = std::move(picture.bytes);
    picture.bytes.clear();
    if (!side.first) side.first = picture;
    if (picture.size != side.first->size || picture.floats != side.first->floats) {
      trouble(side, {ErrorCode::kUnsupported,
                     fmt::format("size or kind of the images has changed to {}x{}",
                                 picture.size.width, picture.size.height),
                     "start the run again"});
    } else if (greeted_) {
      sink_->take(std::move(image));
    } else {
      constexpr std::size_t kMostEarly = 64, kMostEarlyBytes = std::size_t{512} << 20;
      early_bytes_ += image.bytes.size();
      early_.push_back(std::move(image));
      while (early_.size() > kMostEarly || early_bytes_ > kMostEarlyBytes) {
        early_bytes_ -= early_.front().bytes.size();
        early_.pop_front();
      }
    }
  }

  /// An image that cannot be used is left out. Before the greeting the first one is a reason to
  /// end, unless others come that will do.
  void trouble(const Side& side, Error error) {
    constexpr std::size_t kEnough = 20;
    error.message = fmt::format("{}: {}", side.topic, error.message);
    if (said_.size() >= kEnough || !said_.insert(error.message).second) return;
    const std::string words = "images are left out: " + error.message;
    if (greeted_) {
      std::fprintf(stderr, "note: %s\n", words.c_str());
    } else {
      notes_.push_back(words);
      if (!trouble_) trouble_ = std::move(error);
    }
  }

  bool registered() const {
    const std::string &a = color().first->header.frame_id, &b = depth().first->header.frame_id;
    return options_->registered == "on" || named_registered(depth().topic) ||
           (a == b && !a.empty());
  }

  /// What is still missing of what has to be there.
  std::string missing() const {
    for (const Side& side : sides_) {
      if (!side.first) return fmt::format("no image has come on {}", side.topic);
    }
    if (!color_info_) return fmt::format("no camera info has come on {}", topics_.color_info);
    if (registered()) return {};
    if (!depth_info_)
      return fmt::format("{} is not registered to colour", depth().topic) +
             ", and nobody publishes its camera info";
    if (!frames_.between(color().first->header.frame_id, depth().first->header.frame_id)) {
      return fmt::format(
          "{} is in the frame '{}', colour in '{}', and /tf_static does not say how "
          "they lie",
          depth().topic, depth().first->header.frame_id, color().first->header.frame_id);
    }
    return {};
  }

  /// Why that is missing, as far as it can be told.
  Error reason(const std::string& what) const {
    for (const Side& side : sides_) {
      dds_requested_incompatible_qos_status_t status{};
      const bool refused = !side.first &&
                           dds_get_requested_incompatible_qos_status(side.reader, &status) == 0 &&
                           status.total_count > 0;
      if (refused) {
        return {ErrorCode::kUnsupported,
                fmt::format("{} is published as best effort only, and every=on asks for all of it",
                            side.topic),
                "leave out every=on, or let the node publish reliably"};
      }
    }
    const bool images = color().first && depth().first && color_info_;
    return {ErrorCode::kNotFound, what,
            images ? "let the node publish registered depth (realsense2_camera: "
                     "align_depth.enable:=true), or say ,registered=on where it is"
                   : "is the camera's node running? Large images get lost where net.core.rmem_max "
                     "is small"};
  }

  Result<stream::Hello> greeting() {
    std::string what;
    while (!(what = missing()).empty()) {
      if (trouble_) return tl::unexpected<Error>(*trouble_);
      if (Clock::now() > until_) return tl::unexpected<Error>(reason(what));
      take();
    }
    find_imu();
    stream::Hello hello;
    hello.name = "ros2";
    SGS_ASSIGN_OR_RETURN(hello.color_camera, lens_of(*color_info_, color(), topics_.color_info));
    SGS_RETURN_IF_ERROR(place_depth(hello));
    hello.depth = depth().first->floats ? stream::StreamDepth::kF32 : stream::StreamDepth::kU16;
    hello.T_color_imu = T_color_imu_;
    return hello;
  }

  Result<LensCamera> lens_of(const bag::CameraInfoMessage& info, const Side& side,
                             const std::string& topic) {
    return dataset::lens_of(info, topic, dataset::is_rectified(side.topic), side.first->size,
                            notes_);
  }

  Status place_depth(stream::Hello& hello) {
    if (registered()) {
      if (depth().first->size == color().first->size) return {};
      if (!dataset::same_shape(depth().first->size, color().first->size)) {
        const auto [width, height] = depth().first->size;
        return fail(ErrorCode::kUnsupported,
                    fmt::format("{} of {}x{} cannot lie on colour of {}x{}", depth().topic, width,
                                height, color().first->size.width, color().first->size.height),
                    "name another topic: ,depth=/TOPIC");
      }
      hello.depth_camera = dataset::scaled_lens(hello.color_camera, depth().first->size);
      return {};
    }
    SGS_ASSIGN_OR_RETURN(hello.depth_camera, lens_of(*depth_info_, depth(), topics_.depth_info));
    hello.T_color_depth =
        *frames_.between(color().first->header.frame_id, depth().first->header.frame_id);
    leave_out_equal_cameras(hello);
    return {};
  }

  /// How the inertial unit sits, where that is said within a second.
  void find_imu() {
    if (imu_reader_ <= 0) return;
    const auto patience = Clock::now() + std::chrono::seconds(1);
    while (!T_color_imu_ && Clock::now() < patience) {
      if (imu_frame_) T_color_imu_ = frames_.between(color().first->header.frame_id, *imu_frame_);
      if (!T_color_imu_) take();
    }
    if (!T_color_imu_) {
      notes_.push_back(fmt::format(
          "{} is not used: nothing comes there, or /tf_static does not say how the unit sits",
          topics_.imu));
    }
  }

  void listen(const std::stop_token& stop) try {
    greeted_ = true;
    for (const bag::ImuMessage& sample : std::exchange(early_samples_, {})) take(sample);
    for (CameraImage& image : early_) sink_->take(std::move(image));
    early_.clear();
    while (!stop.stop_requested()) take();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "note: images are not taken any more: %s\n", error.what());
  }

  Side& color() { return sides_[0]; }
  Side& depth() { return sides_[1]; }
  const Side& color() const { return sides_[0]; }
  const Side& depth() const { return sides_[1]; }

  std::shared_ptr<const Ros2Options> options_;
  Clock::time_point until_;
  std::unique_ptr<ros2::DdsNode> node_;
  CameraTopics topics_;
  std::array<Side, 2> sides_;
  dds_entity_t waiting_ = 0, color_info_reader_ = 0, depth_info_reader_ = 0, imu_reader_ = 0,
               tf_reader_ = 0;
  std::optional<bag::CameraInfoMessage> color_info_, depth_info_;
  std::optional<std::string> imu_frame_;
  ros2::FrameTree frames_;
  std::optional<SE3> T_color_imu_;
  std::optional<Error> trouble_;
  // From here on of the thread that listens, once there is one.
  bool greeted_ = false;
  std::deque<CameraImage> early_;
  std::size_t early_bytes_ = 0;
  std::deque<bag::ImuMessage> early_samples_;
  std::set<std::string> said_;
  std::jthread listener_;
};

}  // namespace

std::unique_ptr<capture::CameraDriver> make_ros2_driver(
    std::shared_ptr<const Ros2Options> options) {
  return std::make_unique<Ros2Camera>(std::move(options));
}

}  // namespace sgs::cameras
