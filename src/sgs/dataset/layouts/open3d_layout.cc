// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>

#include "sgs/camera/image_side.h"
#include "sgs/dataset/frame_list.h"
#include "sgs/dataset/pairing.h"
#include "sgs/dataset/rigid.h"
#include "sgs/io/atomic_file.h"
#include "sgs/io/json_file.h"
#include "sgs/io/text.h"

namespace sgs::dataset {
namespace fs = std::filesystem;
namespace {

constexpr double kOpen3dDepthScale = 1000;

fs::path first_there(const fs::path& folder, std::span<const char* const> names) {
  for (const char* name : names) {
    const fs::path entry = entry_of(folder, name);
    if (fs::exists(entry)) return entry;
  }
  return {};
}

fs::path open3d_intrinsics(const fs::path& folder) {
  constexpr std::array kNames = {"camera_intrinsic.json", "intrinsic.json"};
  return first_there(folder, kNames);
}
fs::path open3d_color(const fs::path& folder) {
  constexpr std::array kNames = {"color", "image", "rgb"};
  return first_there(folder, kNames);
}
fs::path open3d_trajectory(const fs::path& folder) {
  constexpr std::array kNames = {"trajectory.log", "scene/trajectory.log"};
  return first_there(folder, kNames);
}

/// What an intrinsics file says beside the matrix is optional.
struct Open3dIntrinsics {
  Calibration calibration{{}, {}, kOpen3dDepthScale};
  double fps = 30;
};

Result<Open3dIntrinsics> read_open3d_intrinsics(const fs::path& path) {
  SGS_ASSIGN_OR_RETURN(const auto json, io::load_json(path));
  Open3dIntrinsics out;
  return io::read_json(path,
                       R"({"width", "height", "intrinsic_matrix": 9 numbers, column by column})",
                       [&]() -> Result<Open3dIntrinsics> {
                         const auto m = json.at("intrinsic_matrix").get<std::array<double, 9>>();
                         out.calibration.camera = {image_side_px(json.at("width").get<double>()),
                                                   image_side_px(json.at("height").get<double>()),
                                                   m[0],
                                                   m[4],
                                                   m[6],
                                                   m[7]};
                         out.calibration.depth_scale = json.value("depth_scale", kOpen3dDepthScale);
                         out.fps = json.value("fps", out.fps);
                         if (!(out.fps > 0)) out.fps = Open3dIntrinsics{}.fps;
                         return out;
                       });
}

/// Open3D's log: "i j k", then the 4x4 of frame i, camera to world.
Result<std::map<long, std::optional<SE3>>> read_open3d_log(const fs::path& path) {
  constexpr std::size_t kNumbers = 3 + 16;
  SGS_ASSIGN_OR_RETURN(const std::string content, io::read_text(path));
  const auto numbers = io::parse_doubles(content);
  if (!numbers || numbers->size() % kNumbers != 0) {
    return fail(ErrorCode::kInvalidFormat,
                fmt::format("{}: not a list of three integers and a 4x4 pose each", path.string()),
                "remove the file to go without ground truth");
  }
  std::map<long, std::optional<SE3>> poses;
  for (std::size_t i = 0; i < numbers->size(); i += kNumbers) {
    poses.emplace(std::lround((*numbers)[i]),
                  rigid_from_rows(std::span(*numbers).subspan(i + 3, 16)));
  }
  return poses;
}

Status pair_open3d_images(const fs::path& color_folder, double fps, FrameList& out) {
  constexpr double kMaxDifference_s = 0.02;
  const auto color = image_files(color_folder), depth = image_files(entry_of(out.folder, "depth"));
  const auto timed_color = files_with_microseconds(color);
  const auto timed_depth = files_with_microseconds(depth);
  if (timed_color && timed_depth) {
    pair_by_time(*timed_color, *timed_depth, kMaxDifference_s, out);
  } else {
    pair_by_number(by_number(color), by_number(depth), fps, out);
    // Some count from 1; time begins with the first frame all the same.
    const double first_s = out.frames.empty() ? 0 : out.frames.front().timestamp_s;
    const double first = std::round(first_s * fps);
    for (FrameEntry& frame : out.frames) {
      frame.timestamp_s = (std::round(frame.timestamp_s * fps) - first) / fps;
    }
  }
  return require_frames(out, "color/, image/ or rgb/ and depth/ with images of equal number");
}

}  // namespace

bool looks_like_open3d(const fs::path& folder) {
  return !open3d_color(folder).empty() && fs::is_directory(entry_of(folder, "depth")) &&
         (!open3d_intrinsics(folder).empty() || !open3d_trajectory(folder).empty());
}

// Open3D's reconstruction system and Redwood: color/ (image/, rgb/), depth/ in millimetres,
// camera_intrinsic.json, trajectory.log.
Result<FrameList> list_open3d(const fs::path& folder) {
  FrameList out;
  out.layout = "open3d";
  out.name = folder_name(folder);
  out.folder = folder;
  Open3dIntrinsics intrinsics;
  if (const fs::path path = open3d_intrinsics(folder); !path.empty()) {
    SGS_ASSIGN_OR_RETURN(intrinsics, read_open3d_intrinsics(path));
    out.calibration = {intrinsics.calibration, path.string()};
  } else {
    out.missing_calibration =
        "give --camera and --depth-scale (Redwood's PrimeSense recordings: --camera "
        "525,525,319.5,239.5 --depth-scale 1000), or put a camera_intrinsic.json there";
  }
  SGS_RETURN_IF_ERROR(pair_open3d_images(open3d_color(folder), intrinsics.fps, out));
  const fs::path log = open3d_trajectory(folder);
  if (log.empty()) return out;
  const auto poses = read_open3d_log(log);
  if (!poses) {
    truth_or_warning(tl::unexpected(poses.error()), out);
    return out;
  }
  // The log counts frames from 0, whatever the numbers of their files.
  SGS_RETURN_IF_ERROR(add_frame_poses(out, [&](std::size_t i) -> Result<std::optional<SE3>> {
    const auto pose = poses->find(static_cast<long>(i));
    return pose == poses->end() ? std::optional<SE3>{} : pose->second;
  }));
  return out;
}

}  // namespace sgs::dataset
