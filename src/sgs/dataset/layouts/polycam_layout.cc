// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <charconv>
#include <nlohmann/json.hpp>

#include "sgs/camera/image_side.h"
#include "sgs/dataset/frame_list.h"
#include "sgs/dataset/pairing.h"
#include "sgs/dataset/rigid.h"
#include "sgs/io/json_file.h"

namespace sgs::dataset {
namespace fs = std::filesystem;
namespace {

constexpr double kPolycamDepthScale = 1000;
constexpr double kPolycamReach_m = 5;  // beyond it the phone guesses
constexpr int kPolycamMediumConfidence = 127;

/// What Polycam's optimisation corrected, where there is any, else what the phone recorded.
struct PolycamFolders {
  fs::path images, cameras;
};

PolycamFolders polycam_folders(const fs::path& keyframes) {
  if (fs::is_directory(keyframes / "corrected_cameras") &&
      fs::is_directory(keyframes / "corrected_images")) {
    return {keyframes / "corrected_images", keyframes / "corrected_cameras"};
  }
  return {keyframes / "images", keyframes / "cameras"};
}

struct PolycamCamera {
  PinholeCamera camera;
  std::optional<SE3> T_world_camera;
};

Result<PolycamCamera> read_polycam_camera(const fs::path& path) {
  SGS_ASSIGN_OR_RETURN(const auto json, io::load_json(path));
  return io::read_json(
      path, "fx, fy, cx, cy, width, height and t_00 .. t_23", [&]() -> Result<PolycamCamera> {
        const auto number = [&](const char* key) { return json.at(key).get<double>(); };
        PolycamCamera out;
        out.camera = {image_side_px(number("width")),
                      image_side_px(number("height")),
                      number("fx"),
                      number("fy"),
                      number("cx"),
                      number("cy")};
        std::array<double, 12> rows{};
        for (std::size_t i = 0; i < rows.size(); ++i) {
          rows[i] = number(fmt::format("t_{}{}", i / 4, i % 4).c_str());
        }
        if (const auto T = rigid_from_rows(rows)) {
          out.T_world_camera = from_opengl_camera(*T);
        }
        return out;
      });
}

/// File names are times in microseconds.
std::map<long, fs::path> polycam_by_time(const std::vector<fs::path>& files) {
  std::map<long, fs::path> timed;
  for (const fs::path& file : files) {
    const std::string stem = file.stem().string();
    long time = 0;
    const auto parsed = std::from_chars(stem.data(), stem.data() + stem.size(), time);
    if (parsed.ec == std::errc{} && parsed.ptr == stem.data() + stem.size()) {
      timed.emplace(time, file);
    }
  }
  return timed;
}

}  // namespace

bool looks_like_polycam(const fs::path& folder) {
  const fs::path keyframes = folder / "keyframes";
  return fs::is_directory(keyframes / "cameras") ||
         fs::is_directory(keyframes / "corrected_cameras");
}

// A raw export of Polycam: keyframes/{images,cameras,depth,confidence}, or corrected_images and
// corrected_cameras; ARKit's axes, depth smaller than colour, a camera per picture.
Result<FrameList> list_polycam(const fs::path& folder) {
  constexpr double kMicroseconds = 1e6;
  const fs::path keyframes = folder / "keyframes";
  const PolycamFolders folders = polycam_folders(keyframes);
  FrameList out;
  out.layout = "polycam";
  out.name = folder_name(folder);
  out.folder = folder;
  out.depth_size_differs = true;
  out.max_depth_m = kPolycamReach_m;
  out.min_confidence = kPolycamMediumConfidence;
  pair_by_number(polycam_by_time(image_files(folders.images)),
                 polycam_by_time(image_files(keyframes / "depth")), kMicroseconds, out);
  SGS_RETURN_IF_ERROR(
      require_frames(out,
                     "keyframes/images/TIME.jpg with keyframes/depth/TIME.png (a capture with "
                     "LiDAR, exported as raw data)"));
  std::vector<std::optional<SE3>> poses;
  for (FrameEntry& frame : out.frames) {
    const fs::path json = folders.cameras / frame.color.stem().concat(".json");
    SGS_ASSIGN_OR_RETURN(const auto camera, read_polycam_camera(json));
    frame.camera = camera.camera;
    poses.push_back(camera.T_world_camera);
  }
  add_confidence(keyframes / "confidence", out);
  out.calibration = {{typical_camera(out.frames), {}, kPolycamDepthScale},
                     folders.cameras.string()};
  SGS_RETURN_IF_ERROR(
      add_frame_poses(out, [&](std::size_t i) -> Result<std::optional<SE3>> { return poses[i]; }));
  return out;
}

}  // namespace sgs::dataset
