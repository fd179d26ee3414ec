// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/stream/frame_codec.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <type_traits>
#include <utility>

#include "sgs/io/image_io.h"

namespace sgs::stream {
namespace {

// What is copied below lies in memory as it is sent.
static_assert(std::endian::native == std::endian::little);
static_assert(sizeof(Rgb8) == 3 && std::is_trivially_copyable_v<Rgb8>);

constexpr double kNoMeasurement = 65535;
constexpr int kSentJpegQuality = 92;
constexpr const char* kKeepToIt = "the sender must keep to docs/stream.md";

template <class T>
Result<Image<T>> image_of(const std::string& bytes, const PinholeCamera& camera, const char* what) {
  const std::size_t expected =
      sizeof(T) * static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
  if (bytes.size() != expected) {
    return fail(ErrorCode::kInvalidFormat,
                fmt::format("{} has {} bytes where {}x{} pixels take {}", what, bytes.size(),
                            camera.width, camera.height, expected),
                kKeepToIt);
  }
  Image<T> image(camera.width, camera.height);
  std::memcpy(image.data(), bytes.data(), bytes.size());
  return image;
}

template <class T>
std::string bytes_of(const Image<T>& image) {
  return {reinterpret_cast<const char*>(image.data()), image.size() * sizeof(T)};
}

template <class T>
Status check_size(const Image<T>& image, const PinholeCamera& camera, const char* what) {
  if (image.width() == camera.width && image.height() == camera.height) return {};
  return fail(ErrorCode::kInvalidFormat,
              fmt::format("{} is {}x{} but the greeting said {}x{}", what, image.width(),
                          image.height(), camera.width, camera.height),
              kKeepToIt);
}

Result<ColorImage> color_of(Packet& packet, const Hello& hello) {
  const PinholeCamera& camera = hello.color_camera.camera;
  if (hello.color == ColorCoding::kRgb8) {
    return image_of<Rgb8>(packet.color, camera, "colour");
  }
  SGS_ASSIGN_OR_RETURN(auto image, io::decode_color(std::move(packet.color), "colour"));
  SGS_RETURN_IF_ERROR(check_size(image, camera, "colour"));
  return image;
}

/// Metres; what is negative, infinite or no number is no measurement.
DepthImage cleaned(DepthImage depth) {
  for (std::size_t i = 0; i < depth.size(); ++i) {
    float& z = depth.data()[i];
    if (!(z > 0) || !std::isfinite(z)) z = 0;
  }
  return depth;
}

Result<DepthImage> depth_of(Packet& packet, const Hello& hello) {
  const PinholeCamera& camera = hello.camera_of_depth().camera;
  if (hello.depth == StreamDepth::kF32) {
    SGS_ASSIGN_OR_RETURN(auto depth, image_of<float>(packet.depth, camera, "depth"));
    return cleaned(std::move(depth));
  }
  if (hello.depth == StreamDepth::kU16) {
    SGS_ASSIGN_OR_RETURN(const auto raw, image_of<std::uint16_t>(packet.depth, camera, "depth"));
    return io::depth_in_metres(raw, hello.depth_scale);
  }
  SGS_ASSIGN_OR_RETURN(const auto raw, io::decode_raw_depth(std::move(packet.depth), "depth"));
  SGS_RETURN_IF_ERROR(check_size(raw, camera, "depth"));
  return io::depth_in_metres(raw, hello.depth_scale);
}

io::RawDepth raw_depth(const DepthImage& depth, double scale) {
  io::RawDepth raw(depth.width(), depth.height());
  for (std::size_t i = 0; i < depth.size(); ++i) {
    const double value = std::round(static_cast<double>(depth.data()[i]) * scale);
    raw.data()[i] = value > 0 && value < kNoMeasurement ? static_cast<std::uint16_t>(value) : 0;
  }
  return raw;
}

/// Where nothing moves, of a packet with a mask; null where nothing does anywhere.
Result<std::shared_ptr<const PixelMask>> still_of(const Packet& packet, const Hello& hello,
                                                  PairRectifier& rectifier) {
  if (packet.mask.empty()) return nullptr;
  SGS_ASSIGN_OR_RETURN(auto mask,
                       image_of<std::uint8_t>(packet.mask, hello.color_camera.camera, "the mask"));
  const auto stands = std::count(mask.data(), mask.data() + mask.size(), std::uint8_t{0});
  if (stands == 0) {
    return fail(ErrorCode::kInvalidFormat,
                "by its mask all of the picture moves: 0 stands for what is still, any other value "
                "for what moves",
                kKeepToIt);
  }
  if (static_cast<std::size_t>(stands) == mask.size()) return nullptr;
  std::transform(mask.data(), mask.data() + mask.size(), mask.data(),
                 [](std::uint8_t moves) { return moves == 0 ? std::uint8_t{1} : std::uint8_t{0}; });
  return std::make_shared<const PixelMask>(rectifier.rectify(std::move(mask), 1));
}

}  // namespace

FrameDecoder::FrameDecoder(const Hello& hello)
    : hello_(hello), rectifier_(hello.color_camera, hello.depth_camera, hello.T_color_depth) {}

Status FrameDecoder::decode(Packet packet, RgbdFrame& frame) {
  frame.timestamp_s = packet.timestamp_s;
  frame.camera = camera();
  frame.depth_delay_s = packet.depth_delay_s;
  frame.given_T_world_camera = packet.given_T_world_camera;
  if (!std::isfinite(packet.timestamp_s) || !std::isfinite(packet.depth_delay_s)) {
    return fail(ErrorCode::kInvalidFormat, "its time is not a number", kKeepToIt);
  }
  SGS_ASSIGN_OR_RETURN(auto color, color_of(packet, hello_));
  SGS_ASSIGN_OR_RETURN(auto depth, depth_of(packet, hello_));
  SGS_ASSIGN_OR_RETURN(frame.still, still_of(packet, hello_, rectifier_));
  rectifier_.rectify(std::move(color), std::move(depth), frame);
  return {};
}

Result<Packet> encode_frame(const RgbdFrame& frame, const Hello& hello) {
  Packet packet;
  packet.timestamp_s = frame.timestamp_s;
  packet.depth_delay_s = frame.depth_delay_s;
  packet.given_T_world_camera = frame.given_T_world_camera;
  if (hello.version >= kFirstWithMask && frame.still) {
    packet.mask = bytes_of(*frame.still);
    for (char& moves : packet.mask) moves = moves == 0 ? '\xff' : '\0';
  }
  if (hello.color == ColorCoding::kJpeg) {
    SGS_ASSIGN_OR_RETURN(packet.color, io::encode_jpeg(frame.color, kSentJpegQuality));
  } else if (hello.color == ColorCoding::kRgb8) {
    packet.color = bytes_of(frame.color);
  } else {
    return fail(ErrorCode::kUnsupported, "colour is sent as rgb8 or jpeg", "give --color rgb8");
  }
  if (hello.depth == StreamDepth::kF32) {
    packet.depth = bytes_of(frame.depth);
  } else if (hello.depth == StreamDepth::kU16) {
    packet.depth = bytes_of(raw_depth(frame.depth, hello.depth_scale));
  } else {
    return fail(ErrorCode::kUnsupported, "depth is sent as f32 or u16", "give --depth f32");
  }
  return packet;
}

}  // namespace sgs::stream
