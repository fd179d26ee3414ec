// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/sdk_calibration.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string_view>

#include "sgs/bag/wire.h"
#include "sgs/dataset/bags/bag_topics.h"
#include "sgs/io/text.h"

namespace sgs::dataset {
namespace {

using bag::Bag;

constexpr const char* kString = "std_msgs/String";
constexpr const char* kTransform = "geometry_msgs/Transform";
constexpr const char* kFloat = "std_msgs/Float32";
constexpr const char* kCameraInfo = "sensor_msgs/CameraInfo";
constexpr std::string_view kOrbbecProfile = "StreamProfileInfo";

tl::unexpected<Error> unreadable(const std::string& what) {
  return fail(ErrorCode::kInvalidFormat, what,
              "the SDK of another version wrote it; give --camera, --extrinsics and --depth-scale");
}

/// "key=value;key=value"; keys in small letters.
std::map<std::string, std::string> values_of(std::string_view text) {
  std::map<std::string, std::string> values;
  while (!text.empty()) {
    const std::string_view part = text.substr(0, text.find(';'));
    if (const auto equals = part.find('='); equals != std::string_view::npos) {
      values[io::lower_case(std::string(part.substr(0, equals)))] = part.substr(equals + 1);
    }
    text.remove_prefix(std::min(text.size(), part.size() + 1));
  }
  return values;
}

Result<std::vector<double>> numbers_of(const std::map<std::string, std::string>& values,
                                       const std::string& key) {
  const auto found = values.find(key);
  const auto numbers = found == values.end() ? std::nullopt : io::parse_doubles(found->second, ",");
  if (!numbers) return unreadable(fmt::format("no numbers '{}' in a text of the SDK", key));
  return *numbers;
}

Result<double> number_of(const std::map<std::string, std::string>& values, const std::string& key) {
  SGS_ASSIGN_OR_RETURN(const auto numbers, numbers_of(values, key));
  if (numbers.size() == 1) return numbers.front();
  return unreadable(fmt::format("'{}' is no number in a text of the SDK", key));
}

Result<SE3> transform_of_text(const std::string& text) {
  const auto values = values_of(text);
  SGS_ASSIGN_OR_RETURN(const auto rotation, numbers_of(values, "rotation"));
  SGS_ASSIGN_OR_RETURN(const auto translation, numbers_of(values, "translation"));
  std::array<double, 12> numbers{};
  if (rotation.size() != 9 || translation.size() != 3) {
    return unreadable("a transform of the SDK needs nine and three numbers");
  }
  std::copy(rotation.begin(), rotation.end(), numbers.begin());
  std::copy(translation.begin(), translation.end(), numbers.begin() + 9);
  return bag::rigid_from_numbers(numbers, bag::RotationOrder::kColumns);
}

Result<SE3> read_transform(const Bag& bag, std::size_t channel) {
  const bag::Channel& about = bag.channels()[channel];
  SGS_ASSIGN_OR_RETURN(const auto message, first_message(bag, channel));
  if (!message)
    return fail(ErrorCode::kNotFound, fmt::format("{} is empty", about.topic),
                "give --extrinsics tx,ty,tz,qx,qy,qz,qw, depth to colour");
  if (about.type == kTransform) return bag::read_plain_transform(*message, about.encoding);
  SGS_ASSIGN_OR_RETURN(const std::string text, bag::read_string(*message, about.encoding));
  return transform_of_text(text);
}

Result<double> read_unit_m(const bag::Message& message, const bag::Channel& about) {
  if (about.type == kFloat) {
    SGS_ASSIGN_OR_RETURN(const float unit_m, bag::read_float(message, about.encoding));
    return static_cast<double>(unit_m);
  }
  SGS_ASSIGN_OR_RETURN(const std::string text, bag::read_string(message, about.encoding));
  const auto unit_m = io::parse_double(text);
  if (!unit_m) return unreadable(fmt::format("{}: '{}' is no unit", about.topic, text));
  return *unit_m;
}

/// A camera as text: width height fx fy ppx ppy model coeffs.
Result<bag::CameraInfoMessage> camera_info_of_text(const std::string& text) {
  const auto values = values_of(text);
  bag::CameraInfoMessage info;
  constexpr double kLargestSide_px = 1 << 20;
  for (auto [key, side] : {std::pair{"width", &info.width}, std::pair{"height", &info.height}}) {
    SGS_ASSIGN_OR_RETURN(const double value, number_of(values, key));
    *side = static_cast<std::uint32_t>(std::clamp(value, 0.0, kLargestSide_px));
  }
  for (auto [key, place] : {std::pair{"fx", 0}, {"ppx", 2}, {"fy", 4}, {"ppy", 5}}) {
    SGS_ASSIGN_OR_RETURN(info.K[static_cast<std::size_t>(place)], number_of(values, key));
  }
  info.K[8] = 1;
  SGS_ASSIGN_OR_RETURN(info.D, numbers_of(values, "coeffs"));
  if (const auto model = values.find("model"); model != values.end()) {
    info.distortion_model = model->second;
  }
  return info;
}

/// What Orbbec's SDK says of a stream: custom_msg/OBStreamProfileInfo.
struct OrbbecProfile {
  bag::CameraInfoMessage info;
  std::array<double, 12> depth_to_color{};  ///< rotation by rows, millimetres
};

Result<OrbbecProfile> read_orbbec_profile(const bag::Message& message,
                                          const bag::Channel& channel) {
  bag::Wire wire(message.data, channel.encoding);
  OrbbecProfile profile;
  profile.info.header = bag::header_of(wire);
  wire.number<std::uint8_t>();  // kind of stream
  wire.number<std::uint8_t>();  // format
  for (double& value : profile.depth_to_color) value = static_cast<double>(wire.number<float>());
  profile.info.width = wire.number<std::uint16_t>();
  profile.info.height = wire.number<std::uint16_t>();
  wire.number<std::uint16_t>();  // images a second
  for (const std::size_t place : {0, 4, 2, 5}) {
    profile.info.K[place] = static_cast<double>(wire.number<float>());
  }
  std::array<double, 8> d{};  // k1 .. k6 p1 p2
  for (double& value : d) value = static_cast<double>(wire.number<float>());
  if (!wire.ok()) {
    return fail(ErrorCode::kInvalidFormat,
                fmt::format("{}: a message is no {}", channel.topic, channel.type),
                "the SDK of another version wrote it; give --camera and --extrinsics");
  }
  profile.info.K[8] = 1;
  profile.info.distortion_model = "rational_polynomial";
  profile.info.D = {d[0], d[1], d[6], d[7], d[2], d[3], d[4], d[5]};
  return profile;
}

/// "3" of "/cam/sensor_3/frameType_3"; empty for other topics.
std::string orbbec_stream(const std::string& topic) {
  constexpr std::string_view kFrame = "/frameType_";
  const auto at = topic.find(kFrame);
  if (!topic.starts_with("/cam/sensor_") || at == std::string::npos) return "";
  return topic.substr(at + kFrame.size());
}

std::optional<std::size_t> orbbec_channel(const Bag& bag, const std::string& image_topic) {
  const std::string topic = "/cam/streamProfileType_" + orbbec_stream(image_topic);
  for (std::size_t i = 0; i < bag.channels().size(); ++i) {
    const bag::Channel& channel = bag.channels()[i];
    if (channel.topic == topic && channel.type.ends_with(kOrbbecProfile)) return i;
  }
  return std::nullopt;
}

Result<std::optional<SdkExtrinsics>> orbbec_extrinsics(const Bag& bag,
                                                       const std::string& depth_topic) {
  const auto channel = orbbec_channel(bag, depth_topic);
  if (!channel) return std::nullopt;
  SGS_ASSIGN_OR_RETURN(const auto message, first_message(bag, *channel));
  if (!message) return std::nullopt;
  const bag::Channel& about = bag.channels()[*channel];
  SGS_ASSIGN_OR_RETURN(OrbbecProfile profile, read_orbbec_profile(*message, about));
  auto& numbers = profile.depth_to_color;
  for (std::size_t i = 9; i < numbers.size(); ++i) numbers[i] /= 1000;
  const auto T = bag::rigid_from_numbers(numbers, bag::RotationOrder::kRows);
  if (!T) return std::nullopt;  // all zero where colour was not recorded with it
  return SdkExtrinsics{*T, about.topic};
}

}  // namespace

bool is_sdk_topic(const std::string& image_topic) {
  return !sdk_stream(image_topic).empty() || !orbbec_stream(image_topic).empty();
}

std::string sdk_stream(const std::string& topic) {
  constexpr std::string_view kEnd = "/image/data";
  if (!topic.starts_with("/device_") || !topic.ends_with(kEnd)) return "";
  return topic.substr(0, topic.size() - kEnd.size());
}

std::optional<std::size_t> sdk_info_channel(const Bag& bag, const std::string& image_topic) {
  if (!orbbec_stream(image_topic).empty()) return orbbec_channel(bag, image_topic);
  const std::string stream = sdk_stream(image_topic);
  if (stream.empty()) return std::nullopt;
  for (const char* name : {"/info/camera_info", "/camera_info"}) {
    if (const auto found = find_channel(bag, stream + name, {kCameraInfo, kString})) return found;
  }
  return std::nullopt;
}

Result<bag::CameraInfoMessage> read_any_camera_info(const bag::Message& message,
                                                    const bag::Channel& channel) {
  if (channel.type == kString) {
    SGS_ASSIGN_OR_RETURN(const std::string text, bag::read_string(message, channel.encoding));
    return camera_info_of_text(text);
  }
  if (channel.type.ends_with(kOrbbecProfile)) {
    SGS_ASSIGN_OR_RETURN(auto profile, read_orbbec_profile(message, channel));
    return std::move(profile.info);
  }
  return bag::read_camera_info(message, channel.encoding);
}

/// RealSense writes, for each stream of a group, the transform from the group's reference into the
/// stream (librealsense, device::get_extrinsics).
Result<std::optional<SdkExtrinsics>> sdk_extrinsics(const Bag& bag, const std::string& color_topic,
                                                    const std::string& depth_topic) {
  if (!orbbec_stream(depth_topic).empty()) return orbbec_extrinsics(bag, depth_topic);
  const std::string depth = sdk_stream(depth_topic), color = sdk_stream(color_topic);
  if (depth.empty() || color.empty()) return std::nullopt;
  const std::vector<std::string> types = {kTransform, kString};
  for (const bag::Channel& channel : bag.channels()) {
    if (!channel.topic.starts_with(depth + "/tf/")) continue;
    const std::string group = channel.topic.substr(depth.size());
    const auto of_depth = find_channel(bag, channel.topic, types);
    const auto of_color = find_channel(bag, color + group, types);
    if (!of_depth || !of_color) continue;
    SGS_ASSIGN_OR_RETURN(const SE3 T_depth_reference, read_transform(bag, *of_depth));
    SGS_ASSIGN_OR_RETURN(const SE3 T_color_reference, read_transform(bag, *of_color));
    return SdkExtrinsics{T_color_reference * T_depth_reference.inverse(), channel.topic};
  }
  return std::nullopt;
}

Result<std::optional<SdkUnit>> sdk_depth_unit(const Bag& bag, const std::string& depth_topic) {
  const std::string stream = sdk_stream(depth_topic);
  if (stream.empty()) return std::nullopt;
  const std::string sensor = stream.substr(0, stream.rfind('/'));
  for (const char* name : {"Depth Units", "Depth_Units"}) {
    const auto channel =
        find_channel(bag, fmt::format("{}/option/{}/value", sensor, name), {kFloat, kString});
    if (!channel) continue;
    const bag::Channel& about = bag.channels()[*channel];
    SGS_ASSIGN_OR_RETURN(const auto message, first_message(bag, *channel));
    if (!message) continue;
    SGS_ASSIGN_OR_RETURN(const double unit_m, read_unit_m(*message, about));
    if (!(unit_m > 0 && std::isfinite(unit_m))) {
      return fail(ErrorCode::kInvalidFormat,
                  fmt::format("{}: a depth unit of {} m", about.topic, unit_m),
                  "give --depth-scale S (raw units per metre)");
    }
    // Written as float, or with six digits: 0.001f is meant as a thousandth.
    const double units = 1 / unit_m;
    const double whole = std::round(units);
    return SdkUnit{std::abs(units - whole) < 1e-5 * units ? whole : units, about.topic};
  }
  return std::nullopt;
}

}  // namespace sgs::dataset
