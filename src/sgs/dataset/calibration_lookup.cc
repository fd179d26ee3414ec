// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/calibration_lookup.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include "sgs/io/camera_file.h"
#include "sgs/io/text.h"

namespace sgs::dataset {
namespace fs = std::filesystem;
namespace {

/// Number of the TUM camera in a sequence name ("..._freiburg2_desk", "fr1_xyz"), or 0.
int tum_camera_number(const std::string& name) {
  for (const std::string prefix : {"freiburg", "fr"}) {
    for (auto at = name.find(prefix); at != std::string::npos; at = name.find(prefix, at + 1)) {
      const std::size_t digit = at + prefix.size();
      const auto letter = [&](std::size_t i) {
        return std::isalnum(static_cast<unsigned char>(name[i])) != 0;
      };
      const bool bounded = (at == 0 || !letter(at - 1)) && digit < name.size() &&
                           (digit + 1 == name.size() || !letter(digit + 1));
      if (bounded && name[digit] >= '1' && name[digit] <= '3') return name[digit] - '0';
    }
  }
  return 0;
}

/// Calibrations of the colour cameras published with the TUM RGB-D benchmark, and with Bonn's
/// dynamic sequences (Palazzolo et al., IROS 2019).
std::optional<FoundCalibration> known_sequence(const std::string& folder) {
  constexpr double kTumDepthScale = 5000;
  const std::string name = io::lower_case(folder);
  if (name.find("rgbd_bonn") != std::string::npos) {
    FoundCalibration bonn{{}, "known sequence rgbd_bonn", false};
    bonn.calibration.camera = {640, 480, 542.822841, 542.576870, 315.593520, 237.756098};
    bonn.calibration.distortion.k1 = 0.039903;
    bonn.calibration.distortion.k2 = -0.099343;
    bonn.calibration.distortion.p1 = -0.000730;
    bonn.calibration.distortion.p2 = -0.000144;
    bonn.calibration.depth_scale = kTumDepthScale;
    return bonn;
  }
  const int number = tum_camera_number(name);
  if (number == 0) return std::nullopt;
  FoundCalibration found{{}, fmt::format("known sequence freiburg{}", number), false};
  Calibration& c = found.calibration;
  c.depth_scale = kTumDepthScale;
  if (number == 1) {
    c.camera = {640, 480, 517.3, 516.5, 318.6, 255.3};
    c.distortion = {0.2624, -0.9531, -0.0054, 0.0026, 1.1633};
  } else if (number == 2) {
    c.camera = {640, 480, 520.9, 521.0, 325.1, 249.7};
    c.distortion = {0.2312, -0.7849, -0.0033, -0.0001, 0.9172};
  } else {
    c.camera = {640, 480, 535.4, 539.2, 320.1, 247.6};
  }
  return found;
}

/// The eight scenes of Replica as iMAP and NICE-SLAM rendered them, all with one camera, published
/// in a file beside the scenes that is left behind where one of them is copied.
std::optional<FoundCalibration> known_replica_scene(const FrameList& list) {
  constexpr std::array kScenes = {"room0",   "room1",   "room2",   "office0",
                                  "office1", "office2", "office3", "office4"};
  const std::string name = io::lower_case(folder_name(list.folder));
  const bool known = std::find(kScenes.begin(), kScenes.end(), name) != kScenes.end();
  if (list.layout != "replica" || !known) return std::nullopt;
  FoundCalibration found{{}, "known Replica scene " + name, false};
  found.calibration.camera = {1200, 680, 600, 600, 599.5, 339.5};
  found.calibration.depth_scale = 6553.5;
  return found;
}

Result<std::optional<FoundCalibration>> from_files(const std::vector<fs::path>& folders) {
  using Found = std::optional<FoundCalibration>;
  for (const fs::path& folder : folders) {
    const fs::path path = entry_of(folder, "sgs.toml");
    if (!fs::exists(path)) continue;
    SGS_ASSIGN_OR_RETURN(const auto toml, io::load_sequence_toml(path));
    if (toml.calibration) return Found{{*toml.calibration, path.string(), false}};
  }
  for (const fs::path& folder : folders) {
    const fs::path path = entry_of(folder, "camera.txt");
    if (!fs::exists(path)) continue;
    SGS_ASSIGN_OR_RETURN(const auto calibration, io::load_camera_txt(path));
    return Found{{calibration, path.string(), false}};
  }
  for (const fs::path& folder : folders) {
    const fs::path path = entry_of(folder, "cam_params.json");
    if (!fs::exists(path)) continue;
    SGS_ASSIGN_OR_RETURN(const auto calibration, io::load_cam_params_json(path));
    return Found{{calibration, path.string(), false}};
  }
  return Found{};
}

/// What a calibration program left in the folder. It seldom knows the unit of depth. Other files
/// than camera.yaml may have one of the names by chance: what cannot be read goes to `unreadable`.
Result<std::optional<FoundCalibration>> from_camera_file(const std::vector<fs::path>& folders,
                                                         std::optional<Error>& unreadable) {
  using Found = std::optional<FoundCalibration>;
  constexpr std::array kNames = {"camera.yaml",
                                 "camera.yml",
                                 "camera_info.yaml",
                                 "calibration.yaml",
                                 "intrinsics.yaml",
                                 "camera.json",
                                 "camera_intrinsic.json",
                                 "camera_intrinsics.json",
                                 "intrinsics.json",
                                 "intrinsic.json",
                                 "calibration.json",
                                 "cam_K.txt",
                                 "K.txt",
                                 "intrinsics.txt",
                                 "camera-intrinsics.txt",
                                 "camera_intrinsics.txt",
                                 "camera_matrix.txt",
                                 "calibration.txt",
                                 "camera_calibration.yaml"};
  for (const fs::path& folder : folders) {
    for (const char* name : kNames) {
      const fs::path path = entry_of(folder, name);
      if (!fs::exists(path)) continue;
      const auto calibration = io::load_camera_yaml(path);
      if (calibration) return Found{{*calibration, path.string(), false}};
      if (name == kNames.front()) return tl::unexpected(calibration.error());
      if (!unreadable) unreadable = calibration.error();
    }
  }
  return Found{};
}

tl::unexpected<Error> nothing_found(const std::vector<fs::path>& folders, const FrameList& list,
                                    const char* what) {
  if (!list.missing_calibration.empty()) {
    return fail(ErrorCode::kNotFound,
                fmt::format("{}: {} unknown ({} layout)", list.folder.string(), what, list.layout),
                list.missing_calibration);
  }
  std::string places;
  for (const fs::path& folder : folders) {
    places += fmt::format("{}{}", places.empty() ? "" : ", ", folder.string());
  }
  return fail(
      ErrorCode::kNotFound,
      fmt::format(
          "{} unknown: no sgs.toml with [camera], camera.txt, cam_params.json, camera.yaml, "
          "cam_K.txt or file of a like name in {}, and the folder's name is not that of a known "
          "TUM sequence "
          "(freiburg1, freiburg2, freiburg3) or Bonn sequence (rgbd_bonn), nor that of one "
          "of the eight "
          "Replica scenes (room0, office0, ...)",
          what, places),
      "give --camera fx,fy,cx,cy[,k1,k2,p1,p2,k3[,k4,k5,k6]] and --depth-scale S, or write a "
      "camera.txt with one line 'fx fy cx cy width height depth_scale [k1 k2 p1 p2 k3 "
      "[k4 k5 k6]]'");
}

}  // namespace

Result<FoundCalibration> find_calibration(const std::vector<fs::path>& folders,
                                          const FrameList& list, const OpenOptions& options) {
  std::optional<FoundCalibration> found;
  std::optional<Error> unreadable;
  // What the options give in full needs nothing else, not even readable files.
  if (!(options.camera && options.depth_scale)) {
    SGS_ASSIGN_OR_RETURN(found, from_files(folders));
    if (!found && list.calibration) {
      found = {list.calibration->calibration, list.calibration->source, true};
    }
    if (!found) {
      SGS_ASSIGN_OR_RETURN(found, from_camera_file(folders, unreadable));
    }
    if (!found) found = known_sequence(folder_name(list.folder));
    if (!found) found = known_replica_scene(list);
  }
  if (!found && !options.camera && unreadable) return tl::unexpected<Error>(std::move(*unreadable));
  if (!found && !options.camera) return nothing_found(folders, list, "camera calibration");
  FoundCalibration result = found.value_or(FoundCalibration{});
  result.unit_source = result.source;
  if (options.camera) {
    const io::CameraOption& camera = *options.camera;
    result.calibration.camera = {camera.width, camera.height, camera.fx,
                                 camera.fy,    camera.cx,     camera.cy};
    result.calibration.distortion = camera.distortion;
    result.of_layout = false;
    result.source = found ? fmt::format("--camera, depth scale from {}", result.source)
                          : std::string("--camera");
  }
  if (options.depth_scale) {
    result.calibration.depth_scale = *options.depth_scale;
    result.source += " and " + options.depth_scale_source;
    result.unit_source = options.depth_scale_source;
  }
  if (result.calibration.depth_scale == 0 && !options.depth_scale) {
    if (!found) return nothing_found(folders, list, "depth scale");
    return fail(ErrorCode::kNotFound,
                fmt::format("{}: does not say the unit of depth", result.unit_source),
                "give --depth-scale S, raw units per metre: 1000 for millimetres, 5000 for TUM "
                "recordings");
  }
  return result;
}

}  // namespace sgs::dataset
