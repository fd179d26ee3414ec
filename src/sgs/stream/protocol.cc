// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/stream/protocol.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <vector>

#include "sgs/io/calibration_io.h"
#include "sgs/io/json_file.h"

namespace sgs::stream {
namespace {

using Json = nlohmann::json;

constexpr std::string_view kMagic = "SGS";  // and the version, a digit
constexpr std::size_t kMagic_bytes = 4;
constexpr int kNewestVersion = 3;
constexpr const char* kNoStream =
    "this is no stream of frames: it does not begin with SGS1, SGS2 or SGS3";
constexpr char kFrameMark = 'F', kImuMark = 'I';
constexpr std::size_t kLength_bytes = sizeof(std::uint32_t);
constexpr std::size_t kNumbersOfSample = 7, kSample_bytes = kNumbersOfSample * sizeof(double);
static_assert(std::endian::native ==
              std::endian::little);  // samples lie in memory as they are sent
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

/// Of a frame; a reader of an older version would take a mask for the next part.
Result<std::size_t> mask_bytes_of(const Json& json, int version) {
  constexpr const char* kKey = "mask_bytes";
  if (!json.contains(kKey)) return std::size_t{0};
  if (version >= kFirstWithMask) return count_of(json, kKey, kLargestImages_bytes);
  return broken("a frame with a mask in a stream that does not begin with SGS3");
}

Status read_version_2(const Json& json, Hello& hello) {
  constexpr std::string_view kDevice = "device";
  hello.device_clock = json.value("clock", "") == kDevice;
  hello.listens = json.value("listens", false);
  if (json.contains("laser")) hello.laser = json.at("laser").get<bool>();
  if (json.contains("imu")) {
    const Json& imu = json.at("imu");
    SGS_ASSIGN_OR_RETURN(hello.T_color_imu, pose_of(imu.at("color_from_imu"), "color_from_imu"));
  }
  return {};
}

/// A number that may be left out; what is none counts as left out.
std::optional<double> number_if_any(const Json& json, const char* key) {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_number()) return std::nullopt;
  const auto value = found->get<double>();
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

void add_if_any(Json& json, const char* key, const std::optional<double>& value) {
  if (value) json[key] = *value;
}

Result<Hello> hello_of(const Json& json, int version) {
  constexpr std::size_t kLongestName = 100;
  Hello hello;
  hello.version = version;
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
  if (version >= 2) SGS_RETURN_IF_ERROR(read_version_2(json, hello));
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
  if (hello.version >= 2) {
    if (hello.device_clock) json["clock"] = "device";
    if (hello.listens) json["listens"] = true;
    if (hello.laser) json["laser"] = *hello.laser;
    if (hello.T_color_imu) json["imu"] = {{"color_from_imu", pose_json(*hello.T_color_imu)}};
  }
  const std::string text = json.dump(-1, ' ', true, Json::error_handler_t::replace);
  return std::string(kMagic) + std::to_string(hello.version) + length_bytes(text.size()) + text;
}

Result<std::string> encode_packet(const Packet& packet) {
  const std::size_t bytes = packet.color.size() + packet.depth.size() + packet.mask.size();
  if (bytes > kLargestImages_bytes) {
    return fail(ErrorCode::kUnsupported,
                fmt::format("a frame of {} bytes is larger than a stream allows ({})", bytes,
                            kLargestImages_bytes),
                "send it smaller: --max-width, --color jpeg, --depth u16");
  }
  Json json = {{"t", packet.timestamp_s},
               {"color_bytes", packet.color.size()},
               {"depth_bytes", packet.depth.size()}};
  if (!packet.mask.empty()) json["mask_bytes"] = packet.mask.size();
  if (packet.depth_delay_s != 0) json["depth_t"] = packet.timestamp_s + packet.depth_delay_s;
  if (packet.given_T_world_camera) json["pose"] = pose_json(*packet.given_T_world_camera);
  add_if_any(json, "exposure_s", packet.exposure_s);
  add_if_any(json, "depth_exposure_s", packet.depth_exposure_s);
  add_if_any(json, "gain", packet.gain);
  add_if_any(json, "received_t", packet.received_s);
  const std::string text = json.dump();
  return kFrameMark + length_bytes(text.size()) + text + packet.color + packet.depth + packet.mask;
}

std::string encode_imu(std::span<const InertialSample> samples) {
  const std::size_t count = std::min(samples.size(), kLargestImu_bytes / kSample_bytes);
  std::string bytes = kImuMark + length_bytes(count * kSample_bytes);
  for (const InertialSample& sample : samples.first(count)) {
    std::array<double, kNumbersOfSample> numbers{sample.timestamp_s};
    std::ranges::copy(sample.angular_velocity_rad_s, numbers.begin() + 1);
    std::ranges::copy(sample.acceleration_m_s2, numbers.begin() + 4);
    bytes.append(reinterpret_cast<const char*>(numbers.data()), kSample_bytes);
  }
  return bytes;
}

Result<Hello> parse_hello(std::string_view text, int version) {
  SGS_ASSIGN_OR_RETURN(const Json json, io::parse_json(text, "the greeting"));
  return io::read_json("the greeting", "camera {width, height, fx, fy, cx, cy}, color, depth",
                       [&] { return hello_of(json, version); });
}

Status StreamParser::read_header(std::string_view text) {
  SGS_ASSIGN_OR_RETURN(const Json json, io::parse_json(text, "a frame's header"));
  return io::read_json("a frame's header", "t, color_bytes, depth_bytes", [&]() -> Status {
    packet_ = {};
    packet_.timestamp_s = json.at("t").get<double>();
    packet_.depth_delay_s = json.value("depth_t", packet_.timestamp_s) - packet_.timestamp_s;
    packet_.exposure_s = number_if_any(json, "exposure_s");
    packet_.depth_exposure_s = number_if_any(json, "depth_exposure_s");
    packet_.gain = number_if_any(json, "gain");
    packet_.received_s = number_if_any(json, "received_t");
    SGS_ASSIGN_OR_RETURN(color_bytes_, count_of(json, "color_bytes", kLargestImages_bytes));
    SGS_ASSIGN_OR_RETURN(depth_bytes_, count_of(json, "depth_bytes", kLargestImages_bytes));
    SGS_ASSIGN_OR_RETURN(mask_bytes_, mask_bytes_of(json, hello_->version));
    const std::size_t bytes = color_bytes_ + depth_bytes_ + mask_bytes_;
    if (bytes > kLargestImages_bytes) {
      return broken(fmt::format("a frame announces {} bytes; at most {} are allowed", bytes,
                                kLargestImages_bytes));
    }
    if (json.contains("pose")) {
      SGS_ASSIGN_OR_RETURN(packet_.given_T_world_camera, pose_of(json.at("pose"), "pose"));
    }
    return {};
  });
}

/// The length behind the mark of a part, once it is there.
Result<std::optional<std::size_t>> StreamParser::length_of(const char* what,
                                                           std::size_t largest) const {
  if (buffer_.size() < 1 + kLength_bytes) return std::nullopt;
  const std::size_t length = length_at(std::string_view(buffer_).substr(1));
  if (length <= largest) return length;
  return broken(fmt::format("{} of {} bytes; at most {} are allowed", what, length, largest));
}

Result<StreamParser::Part> StreamParser::next_hello() {
  const std::string_view seen = std::string_view(buffer_).substr(0, kMagic.size());
  if (seen != kMagic.substr(0, seen.size())) {
    return broken(kNoStream);
  }
  if (buffer_.size() < kMagic_bytes) return Part::kNone;
  const int version = buffer_[kMagic.size()] - '0';
  if (version < 1 || version > kNewestVersion) {
    return broken(kNoStream);
  }
  const std::size_t json_at = kMagic_bytes + kLength_bytes;
  if (buffer_.size() < json_at) return Part::kNone;
  const std::size_t length = length_at(std::string_view(buffer_).substr(kMagic_bytes));
  if (length > kLargestJson_bytes) {
    return broken(
        fmt::format("a greeting of {} bytes; at most {} are allowed", length, kLargestJson_bytes));
  }
  if (buffer_.size() < json_at + length) return Part::kNone;
  SGS_ASSIGN_OR_RETURN(hello_,
                       parse_hello(std::string_view(buffer_).substr(json_at, length), version));
  buffer_.erase(0, json_at + length);
  return Part::kHello;
}

Result<StreamParser::Part> StreamParser::next_part() {
  if (buffer_.empty()) return Part::kNone;
  const char mark = buffer_.front();
  if (mark == kEndMark.front()) {
    ended_ = true;
    buffer_.clear();
    return Part::kEnd;
  }
  if (mark == kFrameMark) return next_frame();
  if (mark == kImuMark && hello_->version >= 2) return next_imu();
  return broken(fmt::format("a part begins with byte {}, neither F{} nor E",
                            static_cast<int>(static_cast<unsigned char>(mark)),
                            hello_->version >= 2 ? ", I" : ""));
}

Result<StreamParser::Part> StreamParser::next_frame() {
  constexpr std::size_t kJsonAt = 1 + kLength_bytes;
  if (!images_at_) {
    SGS_ASSIGN_OR_RETURN(const auto length, length_of("a frame's header", kLargestJson_bytes));
    if (!length || buffer_.size() < kJsonAt + *length) return Part::kNone;
    SGS_RETURN_IF_ERROR(read_header(std::string_view(buffer_).substr(kJsonAt, *length)));
    images_at_ = kJsonAt + *length;
  }
  const std::size_t depth_at = *images_at_ + color_bytes_, mask_at = depth_at + depth_bytes_;
  const std::size_t end = mask_at + mask_bytes_;
  if (buffer_.size() < end) return Part::kNone;
  packet_.color = buffer_.substr(*images_at_, color_bytes_);
  packet_.depth = buffer_.substr(depth_at, depth_bytes_);
  packet_.mask = buffer_.substr(mask_at, mask_bytes_);
  buffer_.erase(0, end);
  images_at_.reset();
  return Part::kFrame;
}

/// Samples without a time are left out: there is nothing that they could be told apart by.
Result<StreamParser::Part> StreamParser::next_imu() {
  constexpr std::size_t kSamplesAt = 1 + kLength_bytes;
  SGS_ASSIGN_OR_RETURN(const auto length, length_of("inertial samples", kLargestImu_bytes));
  if (!length) return Part::kNone;
  if (*length % kSample_bytes != 0) {
    return broken(
        fmt::format("inertial samples of {} bytes; each takes {}", *length, kSample_bytes));
  }
  if (buffer_.size() < kSamplesAt + *length) return Part::kNone;
  imu_.clear();
  for (std::size_t at = kSamplesAt; at < kSamplesAt + *length; at += kSample_bytes) {
    std::array<double, kNumbersOfSample> numbers{};
    std::memcpy(numbers.data(), buffer_.data() + at, kSample_bytes);
    if (!std::isfinite(numbers[0])) continue;
    imu_.push_back(
        {numbers[0], {numbers[1], numbers[2], numbers[3]}, {numbers[4], numbers[5], numbers[6]}});
  }
  buffer_.erase(0, kSamplesAt + *length);
  return Part::kImu;
}

Result<StreamParser::Part> StreamParser::next() {
  if (failure_) return tl::unexpected<Error>(*failure_);
  if (ended_) return Part::kEnd;
  auto part = hello_ ? next_part() : next_hello();
  if (!part) failure_ = part.error();
  return part;
}

}  // namespace sgs::stream
