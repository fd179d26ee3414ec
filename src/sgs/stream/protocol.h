// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sgs/camera/register_depth.h"
#include "sgs/core/enum_names.h"
#include "sgs/core/error.h"
#include "sgs/geometry/se3.h"

// Frames over a socket or a pipe (docs/stream.md). All numbers little-endian:
//   hello  "SGS1", "SGS2" or "SGS3", u32 length, JSON
//   frame  'F', u32 length, JSON, colour, depth     any number of them; version 3: and a mask
//   imu    'I', u32 length, samples of 7 doubles    from version 2: any number, between frames
//   end    'E'
namespace sgs::stream {

/// How the colour of a frame is sent: bytes r g b row by row, or a file in memory.
enum class ColorCoding { kRgb8, kPng, kJpeg };
constexpr auto enum_names(ColorCoding) {
  using enum ColorCoding;
  return std::to_array<EnumName<ColorCoding>>({{kRgb8, "rgb8"}, {kPng, "png"}, {kJpeg, "jpeg"}});
}

/// How its depth is sent: metres as 32-bit floats, raw units as 16-bit integers, or those as PNG.
enum class StreamDepth { kF32, kU16, kPng16 };
constexpr auto enum_names(StreamDepth) {
  using enum StreamDepth;
  return std::to_array<EnumName<StreamDepth>>({{kF32, "f32"}, {kU16, "u16"}, {kPng16, "png16"}});
}

/// Limits of what is believed. A stream that goes beyond them is refused before anything is
/// allocated for it.
// limit: greeting, or header of a frame, of a stream, bytes
inline constexpr std::size_t kLargestJson_bytes = std::size_t{64} << 10;
// limit: samples of an inertial unit in one part of a stream, bytes
inline constexpr std::size_t kLargestImu_bytes = std::size_t{56} << 10;
// limit: images of a frame of a stream, bytes
inline constexpr std::size_t kLargestImages_bytes = std::size_t{64} << 20;
// limit: side of a stream's images, pixels
inline constexpr int kLargestSide_px = 8192;

/// Version of the greeting from which on frames may bring a mask.
inline constexpr int kFirstWithMask = 3;

/// What a sender says of its frames before the first one.
struct Hello {
  std::string name;  ///< of the recording; becomes part of the run's folder name
  LensCamera color_camera;
  /// Set where depth is not registered to colour; then T_color_depth maps its points there.
  std::optional<LensCamera> depth_camera;
  SE3 T_color_depth;
  ColorCoding color = ColorCoding::kRgb8;
  StreamDepth depth = StreamDepth::kF32;
  double depth_scale = 1000;  ///< raw units per metre, of u16 and png16

  // Version 2, as cameras send it.
  int version = 1;
  /// Times are those of the camera's own clock: it stands anywhere, and somewhere else after the
  /// camera was plugged in again. Otherwise a sender that comes back goes on with the clock it had.
  bool device_clock = false;
  /// The sender reads lines: answers, "lock_exposure" and "stop".
  bool listens = false;
  /// Set where inertial samples come: from the unit's axes and place to the colour camera.
  std::optional<SE3> T_color_imu;
  std::optional<bool> laser;  ///< whether a projector was on

  const LensCamera& camera_of_depth() const { return depth_camera ? *depth_camera : color_camera; }
};

/// One frame as it was sent.
struct Packet {
  double timestamp_s = 0;
  double depth_delay_s = 0;                 ///< by how much later than colour depth was taken
  std::optional<SE3> given_T_world_camera;  ///< a pose that the sender knows
  std::string color, depth;
  // Version 2.
  std::optional<double> exposure_s, depth_exposure_s;  ///< for how long each image was exposed
  std::optional<double> gain;                          ///< of the colour sensor, in its own unit
  std::optional<double> received_s;  ///< when colour came, by the clock of the sender's machine
  /// Version 3: what moves, a byte for each pixel of colour, row by row: 0 = stands still. Empty:
  /// nobody knows of anything.
  std::string mask;
};

/// What an inertial unit measured at one time; NaN = not measured then. Its two halves often have
/// rates of their own.
struct InertialSample {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  double timestamp_s = 0;  ///< by the clock of the frames
  std::array<double, 3> angular_velocity_rad_s = {kNone, kNone, kNone};
  std::array<double, 3> acceleration_m_s2 = {kNone, kNone, kNone};  ///< felt: upwards at rest
};

std::string encode_hello(const Hello& hello);
/// Fails where a frame is larger than the protocol allows. A mask is for greetings of version 3.
Result<std::string> encode_packet(const Packet& packet);
/// One part; samples beyond the limit are left out, the last ones.
std::string encode_imu(std::span<const InertialSample> samples);
inline constexpr std::string_view kEndMark = "E";

/// The greeting's JSON. Missing keys, wrong types, cameras that are none and sizes beyond the
/// limits are errors that name the key.
Result<Hello> parse_hello(std::string_view json, int version = 1);

/// Cuts bytes, as they come, into the parts of a stream. Holds no more than the part in the making,
/// whose announced lengths are checked against the limits first. After an error it stays at it.
class StreamParser {
 public:
  enum class Part {
    kNone,   ///< more bytes are needed
    kHello,  ///< hello() is there
    kFrame,  ///< packet() is there, until the next call
    kImu,    ///< imu() is there, until the next call
    kEnd,    ///< the sender has said so; what follows is ignored
  };

  void push(std::string_view bytes) { buffer_.append(bytes); }
  Result<Part> next();

  const Hello& hello() const { return *hello_; }
  Packet& packet() { return packet_; }
  const std::vector<InertialSample>& imu() const { return imu_; }
  bool has_hello() const { return hello_.has_value(); }
  /// Whether the last part is whole: a stream that ends now ends between two parts.
  bool between_parts() const { return buffer_.empty(); }

 private:
  Result<Part> next_hello();
  Result<Part> next_part();
  Result<Part> next_frame();
  Result<Part> next_imu();
  Result<std::optional<std::size_t>> length_of(const char* what, std::size_t largest) const;
  Status read_header(std::string_view json);

  std::string buffer_;
  std::optional<Hello> hello_;
  Packet packet_;
  std::vector<InertialSample> imu_;
  std::optional<std::size_t> images_at_;  // in the buffer, once a frame's header is read
  std::size_t color_bytes_ = 0, depth_bytes_ = 0, mask_bytes_ = 0;
  bool ended_ = false;
  std::optional<Error> failure_;
};

}  // namespace sgs::stream
