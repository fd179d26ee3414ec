// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "sgs/camera/image_side.h"
#include "sgs/dataset/frame_list.h"
#include "sgs/dataset/rigid.h"
#include "sgs/dataset/time_unit.h"
#include "sgs/io/json_file.h"

namespace sgs::dataset {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::json;

constexpr double kTransformsFps = 30;  // where the file has no times
constexpr const char* kTransformsForm =
    "fl_x, fl_y, cx, cy, w, h (for all or per frame) and frames with file_path, depth_file_path "
    "and transform_matrix (4x4)";

/// A value of the frame, else of the whole file.
template <class T>
std::optional<T> transforms_value(const Json& frame, const Json& all, const char* key) {
  for (const Json* place : {&frame, &all}) {
    const auto found = place->find(key);
    if (found != place->end() && !found->is_null()) return found->get<T>();
  }
  return std::nullopt;
}

/// The camera of a frame. nerfstudio's pixel centres lie at halves, ours at integers.
std::optional<PinholeCamera> transforms_camera(const Json& frame, const Json& all) {
  const auto number = [&](const char* key) { return transforms_value<double>(frame, all, key); };
  constexpr double kHalfPixel = 0.5;
  const auto width = number("w"), height = number("h");
  auto fx = number("fl_x");
  if (const auto angle = number("camera_angle_x"); !fx && angle && width) {
    fx = *width / 2 / std::tan(*angle / 2);
  }
  if (!fx) return std::nullopt;
  PinholeCamera camera;
  camera.width = image_side_px(width.value_or(0));
  camera.height = image_side_px(height.value_or(0));
  camera.fx = *fx;
  camera.fy = number("fl_y").value_or(*fx);
  const auto cx = number("cx"), cy = number("cy");
  if ((!cx || !cy) && (!width || !height)) return std::nullopt;
  camera.cx = cx.value_or(width.value_or(0) / 2) - kHalfPixel;
  camera.cy = cy.value_or(height.value_or(0) / 2) - kHalfPixel;
  return camera;
}

Result<Distortion> transforms_distortion(const fs::path& path, const Json& json) {
  const auto number = [&](const char* key) { return json.value(key, 0.0); };
  const std::string model = json.value("camera_model", "OPENCV");
  if (model == "OPENCV_FISHEYE") {
    const std::array k = {number("k1"), number("k2"), number("k3"), number("k4")};
    return *Distortion::from_coefficients(k, LensModel::kFisheye);
  }
  const bool known = model == "OPENCV" || model == "PINHOLE" || model == "SIMPLE_PINHOLE" ||
                     model == "SIMPLE_RADIAL" || model == "RADIAL" || model == "PERSPECTIVE";
  if (!known || number("k4") != 0) {
    return fail(ErrorCode::kUnsupported,
                fmt::format("{}: cannot remove the distortion of camera model {}{}", path.string(),
                            model, known ? " with k4" : ""),
                "undistort the images first, for example with `colmap image_undistorter`");
  }
  Distortion out;
  out.k1 = number("k1");
  out.k2 = number("k2");
  out.p1 = number("p1");
  out.p2 = number("p2");
  out.k3 = number("k3");
  return out;
}

/// Rows of a 4x4; empty where it is no pose. `scale` was applied to its position.
std::optional<SE3> transforms_pose(const Json& frame, double scale) {
  const auto found = frame.find("transform_matrix");
  if (found == frame.end()) return std::nullopt;
  std::vector<double> rows;
  for (const Json& row : *found) {
    for (const Json& value : row) {
      rows.push_back(value.is_number() ? value.get<double>() : std::nan(""));
    }
  }
  auto T = rigid_from_rows(rows);
  if (!T) return std::nullopt;
  T->t /= scale;
  return from_opengl_camera(*T);
}

struct TransformsFrame {
  std::string name;
  FrameEntry entry;
  std::optional<double> time_s;
  std::optional<SE3> T_world_camera;
};

fs::path transforms_file(const fs::path& folder, const std::string& name) {
  fs::path path = folder / name;
  // Files written for Blender scenes leave the extension out.
  if (!path.has_extension() && !fs::exists(path)) path += ".png";
  return path;
}

Result<std::vector<TransformsFrame>> transforms_frames(const fs::path& path, const Json& json,
                                                       FrameList& out) {
  const double scale = json.value("applied_scale", 1.0);
  std::vector<TransformsFrame> frames;
  for (const Json& frame : json.at("frames")) {
    TransformsFrame f;
    f.name = frame.at("file_path").get<std::string>();
    auto depth = transforms_value<std::string>(frame, Json::object(), "depth_file_path");
    if (!depth) depth = transforms_value<std::string>(frame, Json::object(), "depth_path");
    if (!depth) {
      ++out.color_without_depth;
      continue;
    }
    f.entry.color = transforms_file(out.folder, f.name);
    f.entry.depth = transforms_file(out.folder, *depth);
    f.entry.color_origin = f.entry.depth_origin = path.string();
    f.entry.camera = transforms_camera(frame, json);
    f.time_s = transforms_value<double>(frame, Json::object(), "timestamp");
    f.T_world_camera = transforms_pose(frame, scale > 0 ? scale : 1.0);
    frames.push_back(std::move(f));
  }
  return frames;
}

/// By what the times of all frames are to be divided to be seconds.
double times_a_second(const std::vector<TransformsFrame>& frames, FrameList& out) {
  std::vector<double> times;
  for (const TransformsFrame& f : frames) times.push_back(*f.time_s);
  const bool whole =
      std::all_of(times.begin(), times.end(), [](double t) { return t == std::floor(t); });
  const TimeUnit unit = unit_of_times(std::move(times), whole);
  if (!unit.name.empty()) {
    out.warnings.push_back(fmt::format("{}: its times are {}; they are taken as {:g} a second",
                                       out.folder.string(), unit.name, unit.per_second));
  }
  return unit.per_second;
}

/// In order of time, or of their names where not every frame has a time of its own.
void put_transforms_in_order(std::vector<TransformsFrame>& frames, FrameList& out) {
  const bool timed = std::all_of(frames.begin(), frames.end(), [](const TransformsFrame& f) {
    return f.time_s && std::isfinite(*f.time_s);
  });
  std::stable_sort(frames.begin(), frames.end(),
                   [&](const TransformsFrame& a, const TransformsFrame& b) {
                     return timed ? *a.time_s < *b.time_s : natural_less(a.name, b.name);
                   });
  const auto same = [&](const TransformsFrame& a, const TransformsFrame& b) {
    return timed ? *a.time_s == *b.time_s : a.name == b.name;
  };
  const auto last = std::unique(frames.begin(), frames.end(), same);
  if (last != frames.end()) {
    out.warnings.push_back(fmt::format("{}: {} frames with a repeated {} were dropped",
                                       out.folder.string(), frames.end() - last,
                                       timed ? "time" : "name"));
    frames.erase(last, frames.end());
  }
  if (!timed) {
    out.warnings.push_back(
        fmt::format("{}: frames without a time were put in order of their names, {:.0f} a second",
                    out.folder.string(), kTransformsFps));
  }
  const double per_second = timed ? times_a_second(frames, out) : kTransformsFps;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    frames[i].entry.timestamp_s = (timed ? *frames[i].time_s : static_cast<double>(i)) / per_second;
  }
}

/// Raw units per metre. "depth_unit_scale_factor" is nerfstudio's name for metres per unit,
/// "integer_depth_scale" NeRFCapture's.
double transforms_depth_scale(const Json& json) {
  constexpr double kMillimetre = 1e-3;
  double metres = json.value("depth_unit_scale_factor", 0.0);
  if (!(metres > 0)) metres = json.value("integer_depth_scale", kMillimetre);
  // A reciprocal of 0.001 is not quite 1000.
  const double units = 1 / metres;
  return std::abs(units - std::round(units)) < 1e-9 * units ? std::round(units) : units;
}

Result<FrameList> transforms_list(const fs::path& folder, const fs::path& path, const Json& json) {
  FrameList out;
  out.layout = "nerfstudio";
  out.name = folder_name(folder);
  out.folder = folder;
  out.depth_size_differs = true;
  SGS_ASSIGN_OR_RETURN(auto frames, transforms_frames(path, json, out));
  if (frames.empty()) {
    return fail(ErrorCode::kInvalidFormat,
                fmt::format("{}: none of its {} frames names a depth image (depth_file_path)",
                            path.string(), out.color_without_depth),
                "colour alone is not enough; export the depth images, too");
  }
  put_transforms_in_order(frames, out);
  std::size_t without_pose = 0;
  for (TransformsFrame& f : frames) {
    if (f.T_world_camera) {
      out.truth.push_back({f.entry.timestamp_s, *f.T_world_camera});
    } else {
      ++without_pose;
    }
    out.frames.push_back(std::move(f.entry));
  }
  if (without_pose > 0) {
    out.warnings.push_back(
        fmt::format("{}: {} frames have no usable transform_matrix", path.string(), without_pose));
  }
  Calibration calibration;
  SGS_ASSIGN_OR_RETURN(calibration.distortion, transforms_distortion(path, json));
  calibration.depth_scale = transforms_depth_scale(json);
  if (std::all_of(out.frames.begin(), out.frames.end(),
                  [](const FrameEntry& f) { return f.camera.has_value(); })) {
    calibration.camera = typical_camera(out.frames);
    out.calibration = {calibration, path.string()};
  } else {
    out.missing_calibration = fmt::format(
        "{} lacks fl_x, cx, cy (or camera_angle_x, w, h); give --camera fx,fy,cx,cy and "
        "--depth-scale",
        path.string());
  }
  return out;
}

}  // namespace

bool looks_like_transforms(const fs::path& folder) {
  return fs::exists(folder / "transforms.json");
}

// nerfstudio's transforms.json with depth, and what writes the same (NeRFCapture, SplaTAM).
Result<FrameList> list_transforms(const fs::path& folder) {
  const fs::path path = folder / "transforms.json";
  SGS_ASSIGN_OR_RETURN(const Json json, io::load_json(path));
  return io::read_json(path, kTransformsForm, [&] { return transforms_list(folder, path, json); });
}

}  // namespace sgs::dataset
