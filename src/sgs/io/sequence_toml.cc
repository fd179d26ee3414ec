// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>
#include <vector>

#include "sgs/core/text.h"
#include "sgs/io/atomic_file.h"
#include "sgs/io/calibration_io.h"
#include "sgs/io/text.h"
#include "sgs/io/toml_library.h"

namespace sgs::io {
namespace fs = std::filesystem;
namespace {

void declare(ParameterList& list, SequenceToml& content, Calibration& c) {
  constexpr double kLargest = 1e6;
  {
    const auto scope = list.group("camera");
    list.add("fx", c.camera.fx, "Focal length in x.", "px", {1e-3, kLargest});
    list.add("fy", c.camera.fy, "Focal length in y.", "px", {1e-3, kLargest});
    list.add("cx", c.camera.cx, "Principal point, x.", "px", {-kLargest, kLargest});
    list.add("cy", c.camera.cy, "Principal point, y.", "px", {-kLargest, kLargest});
    list.add("width", c.camera.width, "Image width.", "px", {1, kLargest});
    list.add("height", c.camera.height, "Image height.", "px", {1, kLargest});
    list.add("depth_scale", c.depth_scale, "Raw depth units per metre.", "1/m", {1e-6, 1e9});
    list.add("lens", c.distortion.model, "How the lens pictures directions.");
  }
  const auto scope = list.group("sequence");
  list.add("name", content.name, "Name for reports.", {});
  list.add("color", content.color, "Folder or pattern of the colour images.", {});
  list.add("depth", content.depth, "Folder or pattern of the depth images.", {});
  list.add("match", content.match, "How colour and depth belong together.");
  list.add("fps", content.fps, "Frames per second.", "1/s", {1e-3, 1e5});
  list.add("trajectory", content.trajectory, "Ground truth, TUM text.", {});
}

Result<Distortion> read_distortion(const toml::node& node, bool fisheye, std::string_view source) {
  const auto bad = [&] {
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: camera.distortion must be five or eight numbers "
                            "[k1, k2, p1, p2, k3, k4, k5, k6], with lens = \"fisheye\" four "
                            "[k1, k2, k3, k4]",
                            toml_place(node, source)),
                "write zeros, or leave the key out when there is no distortion");
  };
  const auto* array = node.as_array();
  if (array == nullptr) return bad();
  const bool fits = fisheye ? array->size() == 4 : array->size() == 5 || array->size() == 8;
  if (!fits) return bad();
  std::vector<double> values;
  for (const toml::node& item : *array) {
    const auto value = item.value<double>();
    if (!value || !(std::abs(*value) <= std::numeric_limits<double>::max())) return bad();
    values.push_back(*value);
  }
  return *Distortion::from_coefficients(values, fisheye ? LensModel::kFisheye : LensModel::kBrown);
}

}  // namespace

Result<SequenceToml> load_sequence_toml(const fs::path& path) {
  SGS_ASSIGN_OR_RETURN(const std::string text, read_text(path));
  const std::string source = path.string();
  SGS_ASSIGN_OR_RETURN(toml::table table, parse_toml(text, source));
  SequenceToml content;
  Calibration calibration;
  if (auto* camera = table["camera"].as_table()) {
    for (const char* key : {"fx", "fy", "cx", "cy", "width", "height"}) {
      if (!camera->contains(key)) {
        return fail(ErrorCode::kInvalidFormat,
                    fmt::format("{}: [camera] lacks '{}'", toml_place(*camera, source), key),
                    "fx, fy, cx, cy, width and height are needed");
      }
    }
    if (const auto* distortion = camera->get("distortion")) {
      const bool fisheye = (*camera)["lens"].value_or(std::string()) == "fisheye";
      SGS_ASSIGN_OR_RETURN(calibration.distortion, read_distortion(*distortion, fisheye, source));
      // Arrays are not config values; what remains is checked as one list.
      camera->erase("distortion");
    }
  }
  ParameterList list;
  declare(list, content, calibration);
  SGS_RETURN_IF_ERROR(apply_toml_table(table, source, list));
  if (table.contains("camera")) content.calibration = calibration;
  if (content.color.empty() != content.depth.empty()) {
    return fail(ErrorCode::kInvalidFormat,
                fmt::format("{}: [sequence] needs both 'color' and 'depth', or neither", source));
  }
  return content;
}

Status save_sequence_toml(const fs::path& path, const SequenceToml& content) {
  for (const std::string* text :
       {&content.name, &content.color, &content.depth, &content.trajectory}) {
    if (!is_utf8(*text)) {
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("{}: '{}' is not UTF-8, which is all that a TOML file can hold",
                              path.string(), *text),
                  "rename it");
    }
  }
  std::string text;
  if (content.calibration) {
    const PinholeCamera& k = content.calibration->camera;
    const Distortion& d = content.calibration->distortion;
    text += fmt::format("[camera]\nfx = {}\nfy = {}\ncx = {}\ncy = {}\n", k.fx, k.fy, k.cx, k.cy);
    text += fmt::format("width = {}\nheight = {}\n", k.width, k.height);
    if (content.calibration->depth_scale > 0) {
      text += fmt::format("depth_scale = {}  # raw units per metre\n",
                          content.calibration->depth_scale);
    }
    if (!d.is_zero()) {
      text += fmt::format(
          "lens = \"{}\"\ndistortion = [{}]  # {}\n", to_string(d.model),
          fmt::join(d.written(), ", "),
          d.is_fisheye() ? "k1 k2 k3 k4" : "k1 k2 p1 p2 k3, k4 k5 k6 where the lens is rational");
    }
    text += "\n";
  }
  text += "[sequence]\n";
  const auto add = [&](const char* key, const std::string& value) {
    if (!value.empty()) text += fmt::format("{} = {}\n", key, toml_quoted(value));
  };
  add("name", content.name);
  if (!content.color.empty()) {
    add("color", content.color);
    add("depth", content.depth);
    add("match", to_string(content.match));
    text += fmt::format("fps = {}\n", content.fps);
  }
  add("trajectory", content.trajectory);
  return write_file(path, text);
}

}  // namespace sgs::io
