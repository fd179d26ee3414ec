// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sgs/core/error.h"

namespace sgs::stream {

/// Where a stream comes from or goes to: `live:tcp://HOST:PORT`, `live:PATH` of a pipe, or `live:-`
/// (standard input or output), or a camera: `camera:[FAMILY[:SERIAL]][,KEY=VALUE...]`.
struct Address {
  std::string host;  ///< of TCP, an IP address or localhost; empty: a pipe
  unsigned short port = 0;
  std::string path;  ///< of a pipe; "-" = standard input or output

  /// A camera on this machine, which a program for its family reads (camera_program.h).
  struct Camera {
    std::string family;  ///< "realsense"; empty: the only one that is plugged in
    std::string serial;  ///< empty: the only one of the family
    /// As the program understands them: "--fps=15"; keys are lower-case letters and dashes.
    std::vector<std::string> options;
    double lock_exposure_after_s = 0;  ///< of the camera's time; 0 = never
    bool every_frame = false;          ///< the camera is slowed down rather than frames dropped
  };
  std::optional<Camera> camera = {};
};

/// Whether an input names a stream, that of a camera or any other.
bool is_stream(std::string_view input);
/// Whether it names a camera on this machine.
bool is_camera(std::string_view input);
/// An address that cannot be understood is an error that shows the forms there are.
Result<Address> parse_address(std::string_view input);

}  // namespace sgs::stream
