// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/bags/bag_cameras.h"

#include <array>
#include <cmath>

#include "sgs/dataset/bags/bag_lens.h"
#include "sgs/dataset/bags/bag_modes.h"
#include "sgs/dataset/bags/bag_transforms.h"
#include "sgs/dataset/sdk_calibration.h"
#include "sgs/io/text.h"

namespace sgs::dataset {
namespace {

using bag::Bag;

constexpr const char* kSamePlace = "0,0,0,0,0,0,1";

const std::string& topic_of(const Bag& bag, std::size_t channel) {
  return bag.channels()[channel].topic;
}

ImageSize topic_size(const ImageTopic& images) { return {images.width, images.height}; }

struct FoundLens {
  LensCamera lens;
  CameraInfoSource source;
};

/// The lens that most pictures have.
Result<FoundLens> read_lens(const Bag& bag, std::size_t channel, const ImageTopic& images,
                            std::vector<std::string>& warnings) {
  const std::string& topic = topic_of(bag, channel);
  auto usual = usual_camera_info(bag, channel);
  if (!usual) {
    const std::string& remedy = usual.error().remedy;
    return fail(usual.error().code, fmt::format("{}: {}", topic, usual.error().message),
                fmt::format("{}{}give --camera fx,fy,cx,cy[,k1,k2,p1,p2,k3[,k4,k5,k6]]", remedy,
                            remedy.empty() ? "" : "; or "));
  }
  // The first picture may have been taken in another mode than most.
  const ImageSize size = usual->changes ? ImageSize{} : topic_size(images);
  SGS_ASSIGN_OR_RETURN(
      const LensCamera lens,
      lens_of(usual->info, topic, is_rectified(topic_of(bag, images.channel)), size, warnings));
  if (usual->changes) {
    warnings.push_back(fmt::format(
        "{}: the camera info changes on the way; pictures are brought to the camera that most of "
        "the first ones have, {}x{}",
        topic, lens.camera.width, lens.camera.height));
  }
  return FoundLens{lens, {channel, std::move(usual->info)}};
}

bool is_registered(const Bag& bag, const BagTopics& topics) {
  const std::string &frame = topics.depth.frame_id, &topic = topic_of(bag, topics.depth.channel);
  const bool one_frame = !frame.empty() && frame == topics.color.frame_id;
  return !is_sdk_topic(topic) && (named_as_registered(topic) || one_frame);
}

/// Says where another topic has another lens for the same frame. That of depth is compared where
/// depth is brought to colour.
void warn_of_other_infos(const Bag& bag, const BagTopics& topics, const FoundLens& believed,
                         std::vector<std::string>& warnings) {
  const bag::CameraInfoMessage& info = believed.source.info;
  const std::string& topic = topic_of(bag, believed.source.channel);
  const ImageSize size{believed.lens.camera.width, believed.lens.camera.height};
  for (const std::size_t channel : camera_infos_of(bag, info.header.frame_id)) {
    if (channel == believed.source.channel || channel == topics.depth_info) continue;
    std::vector<std::string> unsaid;
    const auto usual = usual_camera_info(bag, channel);
    if (!usual || usual->info.width != info.width || usual->info.height != info.height) continue;
    const auto other = lens_of(usual->info, topic,
                               is_rectified(topic_of(bag, topics.color.channel)), size, unsaid);
    if (!other || same_lens(*other, believed.lens)) continue;
    warnings.push_back(fmt::format(
        "{} and {} give frame {} different lenses; {} is believed, --topics color_info={} takes "
        "the other",
        topic, topic_of(bag, channel), info.header.frame_id, topic, topic_of(bag, channel)));
  }
}

Status color_camera(const Bag& bag, const BagTopics& topics, const OpenOptions& options,
                    BagCameras& found) {
  const std::string& topic = topic_of(bag, topics.color.channel);
  if (options.camera) {
    const io::CameraOption& k = *options.camera;
    found.color_source = "--camera";
    const ImageSize size = topic_size(topics.color), own{k.width, k.height};
    found.color = {{size.width, size.height, k.fx, k.fy, k.cx, k.cy}, k.distortion};
    if (!own.known() || !size.known() || own == size) return {};
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("--camera is for pictures of {}x{}, those of {} have {}x{}", own.width,
                            own.height, topic, size.width, size.height),
                "give the calibration of pictures of this size");
  }
  Error error{ErrorCode::kNotFound,
              fmt::format("{}: no camera info beside it, so its calibration is not known; camera "
                          "infos: {}",
                          topic, camera_info_topics(bag)),
              "give --camera fx,fy,cx,cy[,k1,k2,p1,p2,k3[,k4,k5,k6]], or --topics "
              "color_info=/TOPIC"};
  if (topics.color_info) {
    auto lens = read_lens(bag, *topics.color_info, topics.color, found.warnings);
    if (lens) {
      const bool chosen = options.topics.find("color_info=") != std::string::npos;
      if (!chosen) warn_of_other_infos(bag, topics, *lens, found.warnings);
      found.color = lens->lens;
      found.color_info = std::move(lens->source);
      found.color_source = topic_of(bag, *topics.color_info);
      return {};
    }
    error = std::move(lens.error());
  }
  // Registered depth is a picture of the colour camera, so its info is that of colour.
  if (error.code == ErrorCode::kNotFound && topics.depth_info && is_registered(bag, topics)) {
    std::vector<std::string> warnings;
    auto lens = read_lens(bag, *topics.depth_info, topics.color, warnings);
    if (lens) {
      const std::string& source = topic_of(bag, *topics.depth_info);
      found.warnings.insert(found.warnings.end(), warnings.begin(), warnings.end());
      found.warnings.push_back(fmt::format(
          "{}; the camera info of the registered depth, {}, is taken", error.message, source));
      found.color = lens->lens;
      found.color_info = std::move(lens->source);
      found.color_source = source;
      return {};
    }
  }
  return tl::unexpected<Error>(std::move(error));
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

/// A driver's topic with the extrinsics.
struct Published {
  SE3 T_color_depth;
  std::string topic;
};
Result<std::optional<Published>> published_extrinsics(const Bag& bag) {
  for (std::size_t i = 0; i < bag.channels().size(); ++i) {
    const bag::Channel& channel = bag.channels()[i];
    if (!channel.topic.ends_with("depth_to_color") || !channel.type.ends_with("/Extrinsics")) {
      continue;
    }
    // OrbbecSDK_ROS copies its SDK's rotation as it is, by rows; realsense-ros has columns.
    const bool orbbec = channel.type.starts_with("orbbec");
    SGS_ASSIGN_OR_RETURN(const auto message, first_message(bag, i));
    if (!message) continue;
    SGS_ASSIGN_OR_RETURN(const SE3 T, bag::read_extrinsics(*message, channel.encoding,
                                                           orbbec ? bag::RotationOrder::kRows
                                                                  : bag::RotationOrder::kColumns));
    return Published{T, channel.topic};
  }
  return std::nullopt;
}

/// How depth stands to colour: a transform, or that both are one camera.
struct Relation {
  enum class Kind { kApart, kNamed, kOneFrame, kGiven } kind = Kind::kApart;
  SE3 T_color_depth;
  std::string source;
};

bool one_camera(const Relation& relation) { return relation.kind != Relation::Kind::kApart; }

/// Extrinsics from a topic of the driver or from tf; where both are there they should agree.
Result<std::optional<Relation>> recorded_relation(const Bag& bag, const BagTopics& topics,
                                                  std::vector<std::string>& warnings) {
  constexpr double kSame_m = 0.005, kSame_rad = 0.02;
  const std::string &from = topics.depth.frame_id, &to = topics.color.frame_id;
  SGS_ASSIGN_OR_RETURN(const auto published, published_extrinsics(bag));
  SGS_ASSIGN_OR_RETURN(const auto tree, TransformTree::read(bag, false));
  warnings.insert(warnings.end(), tree.warnings().begin(), tree.warnings().end());
  const bool named = !from.empty() && !to.empty();
  const auto T = named ? tree.fixed(to, from) : std::nullopt;
  if (published && T) {
    const SE3 difference = published->T_color_depth.inverse() * *T;
    const double angle = Eigen::AngleAxisd(difference.R).angle();
    if (difference.t.norm() > kSame_m || angle > kSame_rad) {
      warnings.push_back(fmt::format(
          "{} and tf from {} to {} contradict each other by {:.1f} mm and {:.2f} degrees; the "
          "topic is believed; --extrinsics says otherwise",
          published->topic, from, to, 1000 * difference.t.norm(), angle * 180 / M_PI));
    }
  }
  if (published) {
    return Relation{Relation::Kind::kApart, published->T_color_depth, published->topic};
  }
  if (!T) return std::nullopt;
  return Relation{Relation::Kind::kApart, *T, fmt::format("tf from {} to {}", from, to)};
}

Result<Relation> find_relation(const Bag& bag, const BagTopics& topics, const OpenOptions& options,
                               std::vector<std::string>& warnings) {
  using Kind = Relation::Kind;
  const std::string &color = topic_of(bag, topics.color.channel),
                    &depth = topic_of(bag, topics.depth.channel);
  if (options.extrinsics == "aligned") return Relation{Kind::kGiven, {}, "--extrinsics"};
  if (!options.extrinsics.empty()) {
    SGS_ASSIGN_OR_RETURN(const SE3 T, parse_extrinsics(options.extrinsics));
    return Relation{Kind::kApart, T, "--extrinsics"};
  }
  SGS_ASSIGN_OR_RETURN(const auto by_sdk, sdk_extrinsics(bag, color, depth));
  if (by_sdk) return Relation{Kind::kApart, by_sdk->T_color_depth, by_sdk->topic};
  // SDKs give all their images the same frame name, or none: that says nothing.
  if (!is_sdk_topic(depth)) {
    if (named_as_registered(depth)) return Relation{Kind::kNamed, {}, "its name"};
    const std::string& frame = topics.depth.frame_id;
    if (!frame.empty() && frame == topics.color.frame_id) {
      return Relation{Kind::kOneFrame, {}, fmt::format("frame {}", frame)};
    }
    SGS_ASSIGN_OR_RETURN(auto recorded, recorded_relation(bag, topics, warnings));
    if (recorded) return std::move(*recorded);
  }
  const std::string left_out =
      warnings.empty() ? "" : fmt::format(" ({})", fmt::join(warnings, "; "));
  return fail(
      ErrorCode::kInvalidArgument,
      fmt::format(
          "{} (frame '{}') is not registered to {} (frame '{}'), and the recording does not "
          "say how the two cameras stand to each other: no usable /tf_static between the frames, "
          "no extrinsics topic{}",
          depth, topics.depth.frame_id, color, topics.color.frame_id, left_out),
      "give --extrinsics tx,ty,tz,qx,qy,qz,qw (depth to colour), or --extrinsics aligned if depth "
      "is registered; or record an aligned depth topic");
}

Status find_unit(const Bag& bag, const BagTopics& topics, const OpenOptions& options,
                 BagCameras& found) {
  const std::string& topic = topic_of(bag, topics.depth.channel);
  if (options.depth_scale) {
    found.unit.units_per_metre = *options.depth_scale;
    found.unit.scale_floats = true;
    found.unit_source = options.depth_scale_source;
    return {};
  }
  SGS_ASSIGN_OR_RETURN(const auto unit, sdk_depth_unit(bag, topic));
  if (unit) {
    found.unit.units_per_metre = unit->units_per_metre;
    found.unit_source = unit->topic;
    return {};
  }
  const bool floats = topics.depth.encoding.find("32FC1") != std::string::npos;
  found.unit_source = floats ? "32FC1 is in metres, REP 118" : "integers are millimetres, REP 118";
  if (floats || !is_sdk_topic(topic)) return {};
  constexpr const char* kAsk =
      "--depth-scale S, raw units per metre: 1000 for millimetres, 10000 for tenths of them, 4000 "
      "for quarters";
  if (sdk_stream(topic).empty()) {
    return fail(ErrorCode::kNotFound,
                fmt::format("{}: the recording does not say the unit of depth, which is a setting "
                            "of this camera",
                            topic),
                fmt::format("give {}", kAsk));
  }
  found.unit_source = "the default of RealSense's cameras";
  found.warnings.push_back(fmt::format(
      "{}: the recording does not say the unit of depth; millimetres are taken, {}; else give {}",
      topic, found.unit_source, kAsk));
  return {};
}

tl::unexpected<Error> two_lenses(const std::string& color, const LensCamera& a,
                                 const std::string& depth, const LensCamera& b,
                                 const Relation& relation) {
  return fail(
      ErrorCode::kInvalidArgument,
      fmt::format("{} ({}x{} fx {:.1f} cx {:.1f}) and {} ({}x{} fx {:.1f} cx {:.1f}) contradict "
                  "each other: by {} they are one camera, by their lenses they are two",
                  color, a.camera.width, a.camera.height, a.camera.fx, a.camera.cx, depth,
                  b.camera.width, b.camera.height, b.camera.fx, b.camera.cx, relation.source),
      fmt::format("give --extrinsics {} if they are two cameras at one place (a simulator's), "
                  "--extrinsics tx,ty,tz,qx,qy,qz,qw if they stand apart, --extrinsics aligned if "
                  "depth is registered and its camera info is wrong",
                  kSamePlace));
}

/// Whether depth has a camera of its own, and which.
Status depth_camera(const Bag& bag, const BagTopics& topics, const OpenOptions& options,
                    const Relation& relation, BagCameras& found) {
  const std::string& topic = topic_of(bag, topics.depth.channel);
  if (one_camera(relation) && (!topics.depth_info || options.camera)) return {};
  if (!topics.depth_info) {
    return fail(
        ErrorCode::kNotFound,
        fmt::format("{}: no camera info beside it, so depth cannot be registered to colour; camera "
                    "infos: {}",
                    topic, camera_info_topics(bag)),
        "give --topics depth_info=/TOPIC, or record an aligned depth topic");
  }
  std::vector<std::string> warnings;
  auto depth = read_lens(bag, *topics.depth_info, topics.depth, warnings);
  if (!depth) {
    if (!one_camera(relation)) return tl::unexpected(depth.error());
    found.warnings.push_back(
        fmt::format("{}; registered depth does not need it", depth.error().message));
    return {};
  }
  const PinholeCamera &c = found.color.camera, &d = depth->lens.camera;
  if (one_camera(relation) && c.width == d.width && c.height == d.height) {
    const bool agree = same_view(c, d);
    if (!agree && relation.kind == Relation::Kind::kOneFrame) {
      return two_lenses(found.color_source, found.color, topic_of(bag, *topics.depth_info),
                        depth->lens, relation);
    }
    if (!agree && relation.kind == Relation::Kind::kNamed) {
      found.warnings.push_back(fmt::format(
          "{} is another camera than {}, but depth is registered by its name, which is believed; "
          "--extrinsics {} takes it for a camera of its own at the same place",
          topic_of(bag, *topics.depth_info), found.color_source, kSamePlace));
    }
    // Registered depth of the same size is the colour camera's, whatever its own info says; of
    // another size it still has to be brought there.
    return {};
  }
  found.depth = depth->lens;
  found.depth_info = std::move(depth->source);
  found.warnings.insert(found.warnings.end(), warnings.begin(), warnings.end());
  return {};
}

}  // namespace

Result<BagCameras> find_bag_cameras(const Bag& bag, const BagTopics& topics,
                                    const OpenOptions& options) {
  BagCameras found;
  SGS_RETURN_IF_ERROR(color_camera(bag, topics, options, found));
  SGS_RETURN_IF_ERROR(find_unit(bag, topics, options, found));
  SGS_ASSIGN_OR_RETURN(const Relation relation,
                       find_relation(bag, topics, options, found.warnings));
  found.T_color_depth = relation.T_color_depth;
  found.relation_source = one_camera(relation)
                              ? fmt::format("depth is registered, says {}", relation.source)
                              : fmt::format("depth is registered with {}", relation.source);
  SGS_RETURN_IF_ERROR(depth_camera(bag, topics, options, relation, found));
  return found;
}

}  // namespace sgs::dataset
