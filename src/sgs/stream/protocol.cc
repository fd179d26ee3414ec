// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/stream/protocol.h"

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "sgs/dataset/json_file.h"
#include "sgs/io/calibration_io.h"

namespace sgs::stream {
namespace {

using Json = nlohmann::json;

constexpr std::string_view kMagic = "SGS1";
constexpr char kFrameMark = 'F';
constexpr std::size_t kLength_bytes = sizeof(std::uint32_t);
constexpr const char* kHelp = "docs/stream.md describes the protocol";

std::string length_bytes(std::size_t length) {
  std::string bytes;
  for (std::size_t i = 0; i < kLength_bytes; ++i) {
    bytes.push_back(static_cast<char>(length >> (8 * i) & 0xFF));
  }
  return bytes;
}

std::size_t length_at(std::string_view bytes) {
  std::size_t length = 0;
  for (std::size_t i = 0; i < kLength_bytes; ++i) {
    length |= std::size_t{static_cast<unsigned char>(bytes[i])} << (8 * i);
  }
  return length;
}

tl::unexpected<Error> broken(std::string what) {
  return fail(ErrorCode::kInvalidFormat, std::move(what), kHelp);
}

Json camera_json(const LensCamera& lens) {
  const PinholeCamera& c = lens.camera;
  Json json = {{"width", c.width}, {"height", c.height}, {"fx", c.fx},
               {"fy", c.fy},       {"cx", c.cx},         {"cy", c.cy}};
  if (!lens.distortion.is_zero()) json["distortion"] = lens.distortion.written();
  if (lens.distortion.is_fisheye()) json["lens"] = to_string(lens.distortion.model);
  return json;
}

/// tx ty tz qx qy qz qw.
Json pose_json(const SE3& T) {
  const Eigen::Quaterniond q = T.quaternion();
  return {T.t.x(), T.t.y(), T.t.z(), q.x(), q.y(), q.z(), q.w()};
}

Result<SE3> pose_of(const Json& json, const char* key) {
  constexpr double kMaxQuaternionError = 1e-2;
  const auto n = json.get<std::vector<double>>();
  if (n.size() == 7) {
    const Eigen::Quaterniond q(n[6], n[3], n[4], n[5]);
    const SE3 T(q, {n[0], n[1], n[2]});
    if (std::abs(q.norm() - 1) <= kMaxQuaternionError && T.all_finite()) return T;
  }
  return broken(
      fmt::format("'{}' is no pose: needed are tx ty tz qx qy qz qw, the last four a "
                  "unit quaternion",
                  key));
}

/// A whole number of at most `largest`.
Result<std::size_t> count_of(const Json& json, const char* key, std::size_t largest) {
  const auto value = json.at(key).get<double>();
  if (value >= 0 && value <= static_cast<double>(largest) && std::floor(value) == value) {
    return static_cast<std::size_t>(value);
  }
  return broken(fmt::format("'{}' is {}; allowed are whole numbers up to {}", key, value, largest));
}

template <NamedEnum E>
Status read_word(const Json& json, const char* key, E& value) {
  if (!json.contains(key)) return {};
  SGS_ASSIGN_OR_RETURN(value, from_string<E>(key, json.at(key).get<std::string>()));
  return {};
}

Result<LensCamera> camera_of(const Json& json, const char* key) {
  LensCamera lens;
  SGS_ASSIGN_OR_RETURN(const auto width, count_of(json, "width", kLargestSide_px));
  SGS_ASSIGN_OR_RETURN(const auto height, count_of(json, "height", kLargestSide_px));
  lens.camera = {static_cast<int>(width),     static_cast<int>(height),
                 json.at("fx").get<double>(), json.at("fy").get<double>(),
                 json.at("cx").get<double>(), json.at("cy").get<double>()};
  LensModel model = LensModel::kBrown;
  SGS_RETURN_IF_ERROR(read_word(json, "lens", model));
  const auto values = json.value("distortion", std::vector<double>());
  const auto distortion = Distortion::from_coefficients(values, model);
  if (!distortion) {
    return broken(
        fmt::format("'{}': {} distortion coefficients; 4, 5 or 8 are understood, 4 of a "
                    "fisheye",
                    key, values.size()));
  }
  lens.distortion = *distortion;
  SGS_RETURN_IF_ERROR(io::check_calibration({lens.camera, lens.distortion, 1}, key));
  return lens;
}

Result<Hello> hello_of(const Json& json) {
  constexpr std::size_t kLongestName = 100;
  Hello hello;
  hello.name = json.value("name", "stream").substr(0, kLongestName);
  SGS_ASSIGN_OR_RETURN(hello.color_camera, camera_of(json.at("camera"), "camera"));
  SGS_RETURN_IF_ERROR(read_word(json, "color", hello.color));
  SGS_RETURN_IF_ERROR(read_word(json, "depth", hello.depth));
  hello.depth_scale = json.value("depth_scale", hello.depth_scale);
  if (!(hello.depth_scale > 0) || !std::isfinite(hello.depth_scale)) {
    return broken("'depth_scale' must be raw units per metre, above 0");
  }
  if (json.contains("depth_camera")) {
    SGS_ASSIGN_OR_RETURN(hello.depth_camera, camera_of(json.at("depth_camera"), "depth_camera"));
    SGS_ASSIGN_OR_RETURN(hello.T_color_depth,
                         pose_of(json.at("color_from_depth"), "color_from_depth"));
  }
  return hello;
}

}  // namespace

std::string encode_hello(const Hello& hello) {
  Json json = {{"name", hello.name},
               {"camera", camera_json(hello.color_camera)},
               {"color", to_string(hello.color)},
               {"depth", to_string(hello.depth)},
               {"depth_scale", hello.depth_scale}};
  if (hello.depth_camera) {
    json["depth_camera"] = camera_json(*hello.depth_camera);
    json["color_from_depth"] = pose_json(hello.T_color_depth);
  }
  const std::string text = json.dump(-1, ' ', true, Json::error_handler_t::replace);
  return std::string(kMagic) + length_bytes(text.size()) + text;
}

Result<std::string> encode_packet(const Packet& packet) {
  if (packet.color.size() + packet.depth.size() > kLargestImages_bytes) {
    return fail(ErrorCode::kUnsupported,
                fmt::format("a frame of {} bytes is larger than a stream allows ({})",
                            packet.color.size() + packet.depth.size(), kLargestImages_bytes),
                "send it smaller: --max-width, --color jpeg, --depth u16");
  }
  Json json = {{"t", packet.timestamp_s},
               {"color_bytes", packet.color.size()},
               {"depth_bytes", packet.depth.size()}};
  if (packet.depth_delay_s != 0) json["depth_t"] = packet.timestamp_s + packet.depth_delay_s;
  if (packet.given_T_world_camera) json["pose"] = pose_json(*packet.given_T_world_camera);
  const std::string text = json.dump();
  return kFrameMark + length_bytes(text.size()) + text + packet.color + packet.depth;
}

Result<Hello> parse_hello(std::string_view text) {
  SGS_ASSIGN_OR_RETURN(const Json json, dataset::parse_json(text, "the greeting"));
  return dataset::read_json("the greeting", "camera {width, height, fx, fy, cx, cy}, color, depth",
                            [&] { return hello_of(json); });
}

Status StreamParser::read_header(std::string_view text) {
  SGS_ASSIGN_OR_RETURN(const Json json, dataset::parse_json(text, "a frame's header"));
  return dataset::read_json("a frame's header", "t, color_bytes, depth_bytes", [&]() -> Status {
    packet_ = {};
    packet_.timestamp_s = json.at("t").get<double>();
    packet_.depth_delay_s = json.value("depth_t", packet_.timestamp_s) - packet_.timestamp_s;
    SGS_ASSIGN_OR_RETURN(color_bytes_, count_of(json, "color_bytes", kLargestImages_bytes));
    SGS_ASSIGN_OR_RETURN(depth_bytes_, count_of(json, "depth_bytes", kLargestImages_bytes));
    if (color_bytes_ + depth_bytes_ > kLargestImages_bytes) {
      return broken(fmt::format("a frame announces {} bytes; at most {} are allowed",
                                color_bytes_ + depth_bytes_, kLargestImages_bytes));
    }
    if (json.contains("pose")) {
      SGS_ASSIGN_OR_RETURN(packet_.given_T_world_camera, pose_of(json.at("pose"), "pose"));
    }
    return {};
  });
}

Result<StreamParser::Part> StreamParser::next_hello() {
  const std::string_view seen = std::string_view(buffer_).substr(0, kMagic.size());
  if (seen != kMagic.substr(0, seen.size())) {
    return broken("this is no stream of frames: it does not begin with SGS1");
  }
  const std::size_t json_at = kMagic.size() + kLength_bytes;
  if (buffer_.size() < json_at) return Part::kNone;
  const std::size_t length = length_at(std::string_view(buffer_).substr(kMagic.size()));
  if (length > kLargestJson_bytes) {
    return broken(
        fmt::format("a greeting of {} bytes; at most {} are allowed", length, kLargestJson_bytes));
  }
  if (buffer_.size() < json_at + length) return Part::kNone;
  SGS_ASSIGN_OR_RETURN(hello_, parse_hello(std::string_view(buffer_).substr(json_at, length)));
  buffer_.erase(0, json_at + length);
  return Part::kHello;
}

Result<StreamParser::Part> StreamParser::next_frame() {
  if (buffer_.empty()) return Part::kNone;
  if (buffer_.front() == kEndMark.front()) {
    ended_ = true;
    buffer_.clear();
    return Part::kEnd;
  }
  if (buffer_.front() != kFrameMark) {
    return broken(fmt::format("a part begins with byte {}, neither F nor E",
                              static_cast<int>(static_cast<unsigned char>(buffer_.front()))));
  }
  const std::size_t json_at = 1 + kLength_bytes;
  if (!images_at_) {
    if (buffer_.size() < json_at) return Part::kNone;
    const std::size_t length = length_at(std::string_view(buffer_).substr(1));
    if (length > kLargestJson_bytes) {
      return broken(fmt::format("a frame's header of {} bytes; at most {} are allowed", length,
                                kLargestJson_bytes));
    }
    if (buffer_.size() < json_at + length) return Part::kNone;
    SGS_RETURN_IF_ERROR(read_header(std::string_view(buffer_).substr(json_at, length)));
    images_at_ = json_at + length;
  }
  const std::size_t end = *images_at_ + color_bytes_ + depth_bytes_;
  if (buffer_.size() < end) return Part::kNone;
  packet_.color = buffer_.substr(*images_at_, color_bytes_);
  packet_.depth = buffer_.substr(*images_at_ + color_bytes_, depth_bytes_);
  buffer_.erase(0, end);
  images_at_.reset();
  return Part::kFrame;
}

Result<StreamParser::Part> StreamParser::next() {
  if (failure_) return tl::unexpected<Error>(*failure_);
  if (ended_) return Part::kEnd;
  auto part = hello_ ? next_frame() : next_hello();
  if (!part) failure_ = part.error();
  return part;
}

}  // namespace sgs::stream
