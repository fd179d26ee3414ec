// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "camera_words.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <initializer_list>
#include <string_view>

#include "usb_devices.h"

namespace sgs::cameras {
namespace {

bool has_any(std::string_view text, std::initializer_list<std::string_view> words) {
  return std::ranges::any_of(
      words, [&](std::string_view word) { return text.find(word) != std::string_view::npos; });
}

/// A device of the family that may not be opened; empty: none.
std::string forbidden_device(const CameraWords& words) {
  for (const UsbWords& usb : words.usb) {
    for (const UsbDevice& device : usb_devices(usb.vendor, usb.product)) {
      if (!device.may_be_opened) return device.node;
    }
  }
  return {};
}

Error no_permission(const std::string& message) {
  return {ErrorCode::kIo, fmt::format("no permission to open the camera ({})", message),
          "install the udev rules 60-sgs-cameras.rules of the package sgs-cameras to "
          "/etc/udev/rules.d, `sudo udevadm control --reload && sudo udevadm trigger`, and plug "
          "the camera in again"};
}

}  // namespace

Error explained(const std::string& message, const CameraWords& words) {
  if (has_any(message,
              {"busy", "Busy", "BUSY", "already opened", "in use", "another application"})) {
    return {ErrorCode::kIo, fmt::format("the camera is used by another program ({})", message),
            "end that program; `fuser /dev/video* /dev/bus/usb/*/*` names it"};
  }
  if (has_any(message, {"ermission", "ACCESS", "EACCES", "not permitted", "ccess denied"})) {
    return no_permission(message);
  }
  if (has_any(message, {"resolve requests", "No matched", "no such mode"})) {
    return {ErrorCode::kInvalidArgument, fmt::format("the camera has no such mode ({})", message),
            fmt::format("ask for another: camera:{},{}; at USB 2 few modes are left", words.family,
                        words.mode)};
  }
  if (has_any(message, {"No device connected", "disconnected", "No such device"})) {
    return {ErrorCode::kIo, fmt::format("the camera is not there any more ({})", message),
            "plug it in again"};
  }
  // Some libraries say only that it failed.
  if (const std::string node = forbidden_device(words); !node.empty()) {
    return no_permission(fmt::format("{}: {}", node, message));
  }
  return {ErrorCode::kIo, fmt::format("the camera's library says: {}", message),
          "unplug the camera and plug it in again"};
}

Error nothing_found(const CameraWords& words) {
  if (const std::string node = forbidden_device(words); !node.empty()) return no_permission(node);
  return {ErrorCode::kNotFound, fmt::format("no {} is plugged in", words.name), words.plug_in};
}

Result<std::size_t> index_of_camera(const std::vector<std::string>& serials,
                                    const std::string& serial, const CameraWords& words) {
  if (serials.empty()) return tl::unexpected<Error>(nothing_found(words));
  if (serial.empty()) return std::size_t{0};
  const auto found = std::ranges::find(serials, serial);
  if (found != serials.end()) return static_cast<std::size_t>(found - serials.begin());
  return fail(ErrorCode::kNotFound,
              fmt::format("no {} with the serial number {} is plugged in", words.name, serial),
              fmt::format("there is {}", fmt::join(serials, ", ")));
}

Status check_usb(const std::string& usb, const capture::CameraMode& mode, const CameraWords& words,
                 std::vector<std::string>& notes) {
  if (!usb.starts_with('2')) return {};
  if (!mode.given) {
    return fail(
        ErrorCode::kUnsupported,
        fmt::format("the camera is connected by USB {}, too slow for {}x{} at {} Hz", usb,
                    mode.width, mode.height, mode.fps),
        fmt::format("{}; or ask for less: camera:{},{}", kPlugIntoUsb3, words.family, words.slow));
  }
  notes.push_back(fmt::format("the camera is connected by USB {}: few modes work", usb));
  return {};
}

}  // namespace sgs::cameras
