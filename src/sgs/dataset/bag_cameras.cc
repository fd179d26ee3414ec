// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/bag_cameras.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include "sgs/bag/messages.h"
#include "sgs/dataset/bag_transforms.h"
#include "sgs/io/text.h"

namespace sgs::dataset {
namespace {

using bag::Bag;

const std::string& topic_of(const Bag& bag, std::size_t channel) {
  return bag.channels()[channel].topic;
}

bool is_rectified(const std::string& topic) {
  std::string base = topic;
  if (const auto at = base.find("/compressed"); at != std::string::npos) base.resize(at);
  return base.substr(base.rfind('/') + 1).find("rect") != std::string::npos;
}

/// The lens of a camera info's K and D.
Result<Distortion> lens_of(const bag::CameraInfoMessage& info, const std::string& topic,
                           std::vector<std::string>& warnings) {
  std::string model = info.distortion_model;
  std::transform(model.begin(), model.end(), model.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const bool straight =
      std::all_of(info.D.begin(), info.D.end(), [](double value) { return value == 0; });
  if (straight) return Distortion{};
  const bool known = model == "plumb_bob" || model == "rational_polynomial" ||
                     model.find("brown") != std::string::npos;
  const auto lens = Distortion::from_coefficients(info.D);
  if (!known || !lens) {
    return fail(ErrorCode::kUnsupported,
                fmt::format("{}: distortion '{}' with {} coefficients", topic,
                            info.distortion_model, info.D.size()),
                "plumb_bob and rational_polynomial are known; record rectified images, or give "
                "--camera fx,fy,cx,cy[,k1,k2,p1,p2,k3[,k4,k5,k6]]");
  }
  if (model.find("inverse") != std::string::npos) {
    warnings.push_back(fmt::format("{}: '{}' is taken for Brown-Conrady, as realsense-ros does",
                                   topic, info.distortion_model));
  }
  return *lens;
}

Result<LensCamera> read_camera(const Bag& bag, std::size_t info_channel,
                               const std::string& image_topic, std::vector<std::string>& warnings) {
  const std::string& topic = topic_of(bag, info_channel);
  SGS_ASSIGN_OR_RETURN(const auto message, first_message(bag, info_channel));
  const auto info = message
                        ? bag::read_camera_info(*message, bag.channels()[info_channel].encoding)
                        : Result<bag::CameraInfoMessage>(fail(ErrorCode::kNotFound, "no message"));
  if (!info) {
    return fail(info.error().code, fmt::format("{}: {}", topic, info.error().message),
                "give --camera fx,fy,cx,cy");
  }
  LensCamera lens;
  const auto& K = info->K;
  const auto& P = info->P;
  if (is_rectified(image_topic) && P[0] > 0) {
    lens.camera = {0, 0, P[0], P[5], P[2], P[6]};
  } else {
    lens.camera = {0, 0, K[0], K[4], K[2], K[5]};
    SGS_ASSIGN_OR_RETURN(lens.distortion, lens_of(*info, topic, warnings));
  }
  lens.camera.width = static_cast<int>(std::min<std::uint32_t>(info->width, 1u << 20));
  lens.camera.height = static_cast<int>(std::min<std::uint32_t>(info->height, 1u << 20));
  const Calibration whole{lens.camera, lens.distortion, 1};
  SGS_RETURN_IF_ERROR(io::check_calibration(whole, topic));
  return lens;
}

Result<LensCamera> color_camera(const Bag& bag, const BagTopics& topics, const OpenOptions& options,
                                BagCameras& found) {
  const std::string& topic = topic_of(bag, topics.color.channel);
  if (options.camera) {
    const io::CameraOption& k = *options.camera;
    found.source = "--camera";
    return LensCamera{{topics.color.width, topics.color.height, k.fx, k.fy, k.cx, k.cy},
                      k.distortion};
  }
  if (!topics.color_info) {
    return fail(ErrorCode::kNotFound,
                fmt::format("{}: no camera info beside it, so its calibration is not known", topic),
                "give --camera fx,fy,cx,cy[,k1,k2,p1,p2,k3[,k4,k5,k6]], or --topics "
                "color_info=/TOPIC");
  }
  found.source = topic_of(bag, *topics.color_info);
  return read_camera(bag, *topics.color_info, topic, found.warnings);
}

/// "tx,ty,tz,qx,qy,qz,qw" of T_color_depth.
Result<SE3> parse_extrinsics(const std::string& text) {
  const auto bad = [&] {
    return fail(ErrorCode::kInvalidArgument, fmt::format("--extrinsics '{}' cannot be read", text),
                "give tx,ty,tz,qx,qy,qz,qw (metres; point in colour = T * point in depth), or "
                "'aligned' where depth is registered to colour");
  };
  std::array<double, 7> n{};
  const auto fields = io::split_fields(text, ",");
  if (fields.size() != n.size()) return bad();
  for (std::size_t i = 0; i < n.size(); ++i) {
    const auto value = io::parse_double(fields[i]);
    if (!value || !std::isfinite(*value)) return bad();
    n[i] = *value;
  }
  const Eigen::Quaterniond q(n[6], n[3], n[4], n[5]);
  constexpr double kUnitTolerance = 0.01;
  if (std::abs(q.norm() - 1) > kUnitTolerance) return bad();
  return SE3(q, {n[0], n[1], n[2]});
}

/// "/device_0/sensor_1/Color_0" of an image topic of RealSense's SDK; empty for other topics.
std::string sdk_stream(const std::string& topic) {
  constexpr std::string_view kEnd = "/image/data";
  if (!topic.starts_with("/device_") || !topic.ends_with(kEnd)) return "";
  return topic.substr(0, topic.size() - kEnd.size());
}

/// RealSense's SDK writes, for each stream of a group, the transform from the group's reference
/// into the stream (librealsense, device::get_extrinsics).
Result<std::optional<SE3>> sdk_extrinsics(const Bag& bag, const std::string& color,
                                          const std::string& depth) {
  const auto type = std::vector<std::string>{"geometry_msgs/Transform"};
  for (const bag::Channel& channel : bag.channels()) {
    if (!channel.topic.starts_with(depth + "/tf/")) continue;
    const std::string group = channel.topic.substr(depth.size());
    const auto of_depth = find_channel(bag, channel.topic, type);
    const auto of_color = find_channel(bag, color + group, type);
    if (!of_depth || !of_color) continue;
    const auto read = [&](std::size_t at) -> Result<SE3> {
      SGS_ASSIGN_OR_RETURN(const auto message, first_message(bag, at));
      if (!message)
        return fail(ErrorCode::kNotFound, fmt::format("{} is empty", topic_of(bag, at)));
      return bag::read_plain_transform(*message, bag.channels()[at].encoding);
    };
    SGS_ASSIGN_OR_RETURN(const SE3 T_depth_reference, read(*of_depth));
    SGS_ASSIGN_OR_RETURN(const SE3 T_color_reference, read(*of_color));
    return std::optional(T_color_reference * T_depth_reference.inverse());
  }
  return std::nullopt;
}

/// The topic of realsense-ros with the extrinsics.
Result<std::optional<SE3>> published_extrinsics(const Bag& bag) {
  for (std::size_t i = 0; i < bag.channels().size(); ++i) {
    const bag::Channel& channel = bag.channels()[i];
    if (!channel.topic.ends_with("depth_to_color") || !channel.type.ends_with("/Extrinsics")) {
      continue;
    }
    SGS_ASSIGN_OR_RETURN(const auto message, first_message(bag, i));
    if (!message) continue;
    SGS_ASSIGN_OR_RETURN(const SE3 T, bag::read_extrinsics(*message, channel.encoding));
    return std::optional(T);
  }
  return std::nullopt;
}

/// How depth stands to colour: a transform, or that both are one camera.
struct Relation {
  bool registered = false;
  SE3 T_color_depth;
  std::string source;
};

Result<Relation> find_relation(const Bag& bag, const BagTopics& topics,
                               const OpenOptions& options) {
  const std::string &color = topic_of(bag, topics.color.channel),
                    &depth = topic_of(bag, topics.depth.channel);
  if (options.extrinsics == "aligned") return Relation{true, {}, "--extrinsics"};
  if (!options.extrinsics.empty()) {
    SGS_ASSIGN_OR_RETURN(const SE3 T, parse_extrinsics(options.extrinsics));
    return Relation{false, T, "--extrinsics"};
  }
  if (const std::string stream = sdk_stream(depth); !stream.empty()) {
    // The SDK gives all its images the same frame name: that says nothing.
    SGS_ASSIGN_OR_RETURN(const auto T, sdk_extrinsics(bag, sdk_stream(color), stream));
    if (T) return Relation{false, *T, stream + "/tf"};
  } else {
    if (named_as_registered(depth)) return Relation{true, {}, "its name"};
    const std::string& frame = topics.depth.frame_id;
    if (!frame.empty() && frame == topics.color.frame_id) {
      return Relation{true, {}, fmt::format("frame {}", frame)};
    }
    SGS_ASSIGN_OR_RETURN(const auto published, published_extrinsics(bag));
    if (published) return Relation{false, *published, "the depth_to_color topic"};
    SGS_ASSIGN_OR_RETURN(const auto tree, TransformTree::read(bag, false));
    const bool named = !frame.empty() && !topics.color.frame_id.empty();
    const auto T = named ? tree.fixed(topics.color.frame_id, frame) : std::nullopt;
    if (T) {
      return Relation{false, *T, fmt::format("tf from {} to {}", frame, topics.color.frame_id)};
    }
  }
  return fail(
      ErrorCode::kInvalidArgument,
      fmt::format(
          "{} (frame '{}') is not registered to {} (frame '{}'), and the recording does not "
          "say how the two cameras stand to each other: no /tf_static between the frames, "
          "no extrinsics topic",
          depth, topics.depth.frame_id, color, topics.color.frame_id),
      "give --extrinsics tx,ty,tz,qx,qy,qz,qw (depth to colour), or --extrinsics aligned if depth "
      "is registered; or record an aligned depth topic");
}

/// The unit that RealSense's SDK writes beside a sensor's streams, as units per metre.
Result<std::optional<double>> sdk_units_per_metre(const Bag& bag, const std::string& depth_topic) {
  const std::string stream = sdk_stream(depth_topic);
  if (stream.empty()) return std::nullopt;
  const std::string sensor = stream.substr(0, stream.rfind('/'));
  for (const char* name : {"Depth Units", "Depth_Units"}) {
    const auto channel =
        find_channel(bag, fmt::format("{}/option/{}/value", sensor, name), {"std_msgs/Float32"});
    if (!channel) continue;
    SGS_ASSIGN_OR_RETURN(const auto message, first_message(bag, *channel));
    if (!message) continue;
    SGS_ASSIGN_OR_RETURN(const float unit_m,
                         bag::read_float(*message, bag.channels()[*channel].encoding));
    if (!(unit_m > 0 && std::isfinite(unit_m))) {
      return fail(ErrorCode::kInvalidFormat,
                  fmt::format("{}: a depth unit of {} m", topic_of(bag, *channel), unit_m),
                  "give --depth-scale S (raw units per metre)");
    }
    // Written as float: 0.001f is meant as a thousandth.
    const double units = 1 / static_cast<double>(unit_m);
    const double whole = std::round(units);
    return std::optional(std::abs(units - whole) < 1e-5 * units ? whole : units);
  }
  return std::nullopt;
}

}  // namespace

Result<BagCameras> find_bag_cameras(const Bag& bag, const BagTopics& topics,
                                    const OpenOptions& options) {
  BagCameras found;
  SGS_ASSIGN_OR_RETURN(found.color, color_camera(bag, topics, options, found));
  const std::string& depth_topic = topic_of(bag, topics.depth.channel);
  if (options.depth_scale) {
    found.unit = {*options.depth_scale, true};
    found.source += " and --depth-scale";
  } else {
    SGS_ASSIGN_OR_RETURN(const auto units, sdk_units_per_metre(bag, depth_topic));
    if (units) found.unit.units_per_metre = *units;
  }
  SGS_ASSIGN_OR_RETURN(const Relation relation, find_relation(bag, topics, options));
  found.T_color_depth = relation.T_color_depth;
  found.source += relation.registered
                      ? fmt::format("; depth is registered, says {}", relation.source)
                      : fmt::format("; depth is registered with {}", relation.source);
  if (relation.registered && !topics.depth_info) return found;
  if (relation.registered && options.camera) return found;
  if (!topics.depth_info) {
    return fail(ErrorCode::kNotFound,
                fmt::format("{}: no camera info beside it, so depth cannot be registered to colour",
                            depth_topic),
                "give --topics depth_info=/TOPIC, or record an aligned depth topic");
  }
  SGS_ASSIGN_OR_RETURN(const LensCamera depth,
                       read_camera(bag, *topics.depth_info, depth_topic, found.warnings));
  // Registered depth of the same size is the colour camera's, whatever its own info says; of
  // another size it still has to be brought there.
  const bool same_size = depth.camera.width == found.color.camera.width &&
                         depth.camera.height == found.color.camera.height;
  if (!relation.registered || !same_size) found.depth = depth;
  return found;
}

}  // namespace sgs::dataset
