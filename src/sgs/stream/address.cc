// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/stream/address.h"

#include <algorithm>
#include <charconv>

namespace sgs::stream {
namespace {

constexpr std::string_view kLive = "live:";
constexpr std::string_view kCamera = "camera:";
constexpr std::string_view kTcp = "tcp://";
constexpr const char* kForms = "live:tcp://127.0.0.1:PORT, live:PIPE or live:- (standard input)";
constexpr const char* kCameraForms =
    "camera:, camera:realsense or camera:realsense:SERIAL, then any of ,size=640x480 ,fps=30 "
    ",skip=15 ,lock=1 ,imu=off ,every=on";

/// The part of `text` before `mark`, which is removed with it.
std::string_view cut(std::string_view& text, char mark) {
  const auto end = std::min(text.find(mark), text.size());
  const std::string_view part = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return part;
}

bool plain(std::string_view word) {
  return std::ranges::all_of(
      word, [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-'; });
}

tl::unexpected<Error> bad_camera(std::string_view input, std::string_view what) {
  return fail(ErrorCode::kInvalidArgument, fmt::format("'{}': {}", input, what), kCameraForms);
}

Status take_option(std::string_view input, std::string_view option, Address::Camera& camera) {
  std::string_view value = option;
  const std::string_view key = cut(value, '=');
  if (key.empty() || value.empty() || !plain(key)) {
    return bad_camera(input, fmt::format("'{}' is no KEY=VALUE", option));
  }
  if (key == "every") {
    camera.every_frame = value == "on";
    if (value != "on" && value != "off") return bad_camera(input, "every is on or off");
  } else if (key == "lock") {
    const auto end = value.data() + value.size();
    const auto read = std::from_chars(value.data(), end, camera.lock_exposure_after_s);
    if (read.ec != std::errc{} || read.ptr != end || !(camera.lock_exposure_after_s >= 0)) {
      return bad_camera(input, "lock is a number of seconds");
    }
    return {};
  }
  camera.options.push_back(fmt::format("--{}={}", key, value));
  return {};
}

Result<Address> parse_camera(std::string_view input) {
  Address address;
  Address::Camera& camera = address.camera.emplace();
  std::string_view rest = input.substr(kCamera.size());
  std::string_view name = cut(rest, ',');
  camera.family = cut(name, ':');
  camera.serial = name;
  if (!plain(camera.family) || (camera.family.empty() && !camera.serial.empty())) {
    return bad_camera(input, "the family of the camera is missing or no name");
  }
  while (!rest.empty()) SGS_RETURN_IF_ERROR(take_option(input, cut(rest, ','), camera));
  return address;
}

}  // namespace

bool is_camera(std::string_view input) { return input.starts_with(kCamera); }
bool is_stream(std::string_view input) { return input.starts_with(kLive) || is_camera(input); }

Result<Address> parse_address(std::string_view input) {
  const auto bad = [&](const char* what) {
    return fail(ErrorCode::kInvalidArgument, fmt::format("'{}': {}", input, what), kForms);
  };
  if (is_camera(input)) return parse_camera(input);
  if (!is_stream(input)) return bad("no stream");
  std::string_view rest = input.substr(kLive.size());
  Address address;
  if (!rest.starts_with(kTcp)) {
    if (rest.empty()) return bad("names nothing");
    if (rest.find("://") != std::string_view::npos) return bad("this kind of stream is not known");
    address.path = rest;
    return address;
  }
  rest.remove_prefix(kTcp.size());
  const auto colon = rest.rfind(':');
  if (colon == std::string_view::npos || colon == 0) return bad("needs an address and a port");
  address.host = rest.substr(0, colon);
  if (address.host.front() == '[' && address.host.back() == ']') {
    address.host = address.host.substr(1, address.host.size() - 2);
  }
  const std::string_view port = rest.substr(colon + 1);
  const auto parsed = std::from_chars(port.data(), port.data() + port.size(), address.port);
  if (parsed.ec != std::errc{} || parsed.ptr != port.data() + port.size()) {
    return bad("the port must be a number from 0 to 65535");
  }
  return address;
}

}  // namespace sgs::stream
