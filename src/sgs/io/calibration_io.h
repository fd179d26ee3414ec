// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "sgs/camera/pinhole.h"
#include "sgs/core/enum_names.h"
#include "sgs/core/error.h"

namespace sgs::io {

/// Intrinsics as given on the command line.
struct CameraOption {
  double fx = 0, fy = 0, cx = 0, cy = 0;
  Distortion distortion;
  // What numbers do not say, and a file may: 0 = not said.
  int width = 0, height = 0;  ///< of the pictures
  double depth_scale = 0;     ///< raw units per metre
};

/// Parses `--camera fx,fy,cx,cy[,k1,k2,p1,p2,k3[,k4,k5,k6]]`: four, nine or twelve finite
/// numbers, fx and fy > 0; or `fx,fy,cx,cy,fisheye,k1,k2,k3,k4`.
Result<CameraOption> parse_camera_option(std::string_view text);

/// Checks a complete calibration: sizes, focal lengths and depth scale positive, everything finite,
/// a distortion that does not fold back within the picture. `source` says in the message where it
/// came from.
Status check_calibration(const Calibration& calibration, std::string_view source);

/// Reads `camera.txt`: one line `fx fy cx cy width height depth_scale [k1 k2 p1 p2 k3
/// [k4 k5 k6]]`, or `... depth_scale fisheye k1 k2 k3 k4`, '#' comments. The result has passed
/// check_calibration().
Result<Calibration> load_camera_txt(const std::filesystem::path& path);
Status save_camera_txt(const std::filesystem::path& path, const Calibration& calibration);

/// Reads NICE-SLAM's `cam_params.json`: {"camera": {w, h, fx, fy, cx, cy, scale}}.
Result<Calibration> load_cam_params_json(const std::filesystem::path& path);

/// How the colour and depth images of a plain folder belong together.
enum class FrameMatching {
  kOrder,  ///< the n-th of both
  kStem,   ///< equal file names without extension
};

constexpr auto enum_names(FrameMatching) {
  using enum FrameMatching;
  return std::to_array<EnumName<FrameMatching>>({{kOrder, "order"}, {kStem, "stem"}});
}

/// What a sequence folder's `sgs.toml` may say.
///
///     [camera]                      # all or nothing; distortion optional
///     fx = 525.0
///     fy = 525.0
///     cx = 319.5
///     cy = 239.5
///     width = 640
///     height = 480
///     depth_scale = 5000.0          # may be left to --depth-scale
///     distortion = [0.0, 0.0, 0.0, 0.0, 0.0]   # k1 k2 p1 p2 k3, or k1 .. k6
///     lens = "brown"                # or "fisheye", with distortion = [k1, k2, k3, k4]
///     [sequence]
///     name = "kitchen"
///     color = "color/*.jpg"         # a folder or a pattern with * in the file name; with `depth`
///     depth = "depth"               #   this makes the folder a plain-folder sequence
///     match = "order"               # or "stem": equal file names without extension
///     fps = 30.0
///     trajectory = "poses.txt"      # ground truth, TUM text
struct SequenceToml {
  std::optional<Calibration> calibration;  ///< depth_scale 0 when the file does not give one
  std::string name;
  std::string color, depth;
  FrameMatching match = FrameMatching::kOrder;
  double fps = 30;
  std::string trajectory;
};

/// Reads `sgs.toml`. Unknown keys, wrong types and values out of range are errors with the line.
Result<SequenceToml> load_sequence_toml(const std::filesystem::path& path);
Status save_sequence_toml(const std::filesystem::path& path, const SequenceToml& content);

}  // namespace sgs::io
