// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/sdk_calibration.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
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
constexpr std::string_view kOrbbecImuProfile = "ImuStreamProfileInfo";
constexpr std::string_view kOrbbecProperty = "OBProperty";
constexpr double kMillimetres = 1000;  // in a metre

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

/// Units per metre of a number that was written as float, or with six digits: 0.001f is meant as a
/// thousandth.
double whole_units(double units) {
  const double whole = std::round(units);
  return std::abs(units - whole) < 1e-5 * units ? whole : units;
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

std::optional<std::size_t> channel_ending(const Bag& bag, const std::string& topic,
                                          std::string_view type) {
  for (std::size_t i = 0; i < bag.channels().size(); ++i) {
    const bag::Channel& channel = bag.channels()[i];
    if (channel.topic == topic && channel.type.ends_with(type)) return i;
  }
  return std::nullopt;
}

/// Streams and frames have the same numbers, but for gyroscopes and what is right and left.
std::optional<std::size_t> orbbec_channel(const Bag& bag, const std::string& image_topic) {
  return channel_ending(bag, "/cam/streamProfileType_" + orbbec_stream(image_topic),
                        kOrbbecProfile);
}

/// Of twelve numbers: a rotation by rows, millimetres; empty where they are none: all zero where
/// the other sensor was not recorded.
std::optional<SE3> orbbec_transform(std::array<double, 12> numbers) {
  for (std::size_t i = 9; i < numbers.size(); ++i) numbers[i] /= kMillimetres;
  const auto T = bag::rigid_from_numbers(numbers, bag::RotationOrder::kRows);
  return T ? std::optional(*T) : std::nullopt;
}

/// Accelerometer to depth, of custom_msg/OBImuStreamProfileInfo.
std::optional<SE3> orbbec_accelerometer(const Bag& bag, const std::string& imu_topic) {
  constexpr int kSettings = 6;  // kind of stream, format, ranges and rates: a byte each
  const auto channel =
      channel_ending(bag, "/cam/streamProfileType_" + orbbec_stream(imu_topic), kOrbbecImuProfile);
  if (!channel) return std::nullopt;
  const auto message = first_message(bag, *channel);
  if (!message || !*message) return std::nullopt;
  bag::Wire wire((*message)->data, bag.channels()[*channel].encoding);
  bag::header_of(wire);
  for (int i = 0; i < kSettings; ++i) wire.number<std::uint8_t>();
  std::array<double, 12> numbers{};
  for (double& number : numbers) number = static_cast<double>(wire.number<float>());
  return wire.ok() ? orbbec_transform(numbers) : std::nullopt;
}

/// The setting with a number, of custom_msg/OBProperty; empty where it was not recorded.
template <class T>
std::optional<T> orbbec_property(const Bag& bag, std::size_t channel, std::uint32_t wanted) {
  const auto cursor = bag.read({channel});
  while (true) {
    const auto message = cursor->next();
    if (message && !*message) return std::nullopt;
    if (!message) continue;
    bag::Wire wire((*message)->data, bag.channels()[channel].encoding);
    bag::header_of(wire);
    const auto number = wire.number<std::uint32_t>();
    const std::string_view data = wire.bytes();
    if (!wire.ok() || number != wanted || data.size() != sizeof(T)) continue;
    T value{};
    std::memcpy(&value, data.data(), sizeof(T));
    return value;
  }
}

/// Millimetres of a unit of depth: newer cameras have a number for it, older ones a list to choose
/// from (OBDepthPrecisionLevel).
Result<std::optional<SdkUnit>> orbbec_depth_unit(const Bag& bag) {
  constexpr const char* kTopic = "/cam/property";
  constexpr std::uint32_t kUnit = 176, kLevel = 75;
  constexpr std::array kLevels_mm = {1.0, 0.8, 0.4, 0.1, 0.2, 0.5, 0.05};
  const auto channel = channel_ending(bag, kTopic, kOrbbecProperty);
  if (!channel) return std::nullopt;
  if (const auto unit_mm = orbbec_property<float>(bag, *channel, kUnit)) {
    const auto unit = static_cast<double>(*unit_mm);
    if (unit > 0 && std::isfinite(unit)) return SdkUnit{whole_units(kMillimetres / unit), kTopic};
    return fail(ErrorCode::kInvalidFormat, fmt::format("{}: a depth unit of {} mm", kTopic, unit),
                "give --depth-scale S (raw units per metre)");
  }
  const auto level = orbbec_property<std::int32_t>(bag, *channel, kLevel);
  if (!level || *level < 0 || *level >= std::ssize(kLevels_mm)) return std::nullopt;
  return SdkUnit{kMillimetres / kLevels_mm[static_cast<std::size_t>(*level)], kTopic};
}

Result<std::optional<SdkExtrinsics>> orbbec_extrinsics(const Bag& bag,
                                                       const std::string& depth_topic) {
  const auto channel = orbbec_channel(bag, depth_topic);
  if (!channel) return std::nullopt;
  SGS_ASSIGN_OR_RETURN(const auto message, first_message(bag, *channel));
  if (!message) return std::nullopt;
  const bag::Channel& about = bag.channels()[*channel];
  SGS_ASSIGN_OR_RETURN(const OrbbecProfile profile, read_orbbec_profile(*message, about));
  const auto T = orbbec_transform(profile.depth_to_color);
  if (!T) return std::nullopt;
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

std::optional<Eigen::Matrix3d> sdk_imu_rotation(const Bag& bag, const std::string& imu_topic) {
  constexpr const char* kDepth = "/cam/sensor_3/frameType_3";
  if (orbbec_stream(imu_topic).empty()) return std::nullopt;
  const auto T_depth_imu = orbbec_accelerometer(bag, imu_topic);
  const auto depth = orbbec_extrinsics(bag, kDepth);
  if (!T_depth_imu || !depth || !*depth) return std::nullopt;
  return (*depth)->T_color_depth.R * T_depth_imu->R;
}

Result<std::optional<SdkUnit>> sdk_depth_unit(const Bag& bag, const std::string& depth_topic) {
  if (!orbbec_stream(depth_topic).empty()) return orbbec_depth_unit(bag);
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
    return SdkUnit{whole_units(1 / unit_m), about.topic};
  }
  return std::nullopt;
}

}  // namespace sgs::dataset
