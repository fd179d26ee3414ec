// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/io/depth_calibration_io.h"

#include <cmath>

#include "sgs/io/atomic_file.h"
#include "sgs/io/toml_library.h"

namespace sgs::io {
namespace fs = std::filesystem;
namespace {

constexpr int kFormat = 1;
// limit: nodes on a side of a depth calibration
constexpr int kMostNodes = 256;       // on a side
constexpr double kLargestOffset = 1;  // 1/m
constexpr double kLargestShift = 1000;
constexpr double kLongestDelay_s = 1;

/// The scalars of the file.
struct Scalars {
  int format = kFormat;

  void declare(ParameterList& list, DepthCalibration& c) {
    constexpr double kLargest = 1e6;
    list.add("format", format, "Format of the file.", "", {1, 1e6});
    {
      const auto scope = list.group("camera");
      list.add("fx", c.camera.fx, "Focal length in x.", "px", {1e-3, kLargest});
      list.add("fy", c.camera.fy, "Focal length in y.", "px", {1e-3, kLargest});
      list.add("cx", c.camera.cx, "Principal point, x.", "px", {-kLargest, kLargest});
      list.add("cy", c.camera.cy, "Principal point, y.", "px", {-kLargest, kLargest});
      list.add("width", c.camera.width, "Image width.", "px", {1, 65536});
      list.add("height", c.camera.height, "Image height.", "px", {1, 65536});
    }
    const auto scope = list.group("depth");
    list.add("columns", c.grid.columns, "Nodes across the image.", "", {1, kMostNodes});
    list.add("rows", c.grid.rows, "Nodes down the image.", "", {1, kMostNodes});
    list.add("mean_sigma_per_m", c.mean_sigma_per_m, "Of the mean offset.", "1/m", {0, kLargest});
    list.add("shift_u_px", c.shift_px.x(), "Shift of depth against colour.", "px",
             {-kLargestShift, kLargestShift});
    list.add("shift_v_px", c.shift_px.y(), "Shift of depth against colour.", "px",
             {-kLargestShift, kLargestShift});
    list.add("shift_u_sigma_px", c.shift_sigma_px.x(), "Its deviation.", "px", {0, kLargest});
    list.add("shift_v_sigma_px", c.shift_sigma_px.y(), "Its deviation.", "px", {0, kLargest});
    list.add("delay_s", c.delay_s, "Of depth after colour.", "s",
             {-kLongestDelay_s, kLongestDelay_s});
    list.add("delay_sigma_s", c.delay_sigma_s, "Its deviation.", "s", {0, kLargest});
  }
};

/// Takes an array of numbers out of the table.
Result<std::vector<double>> take_numbers(toml::table& table, const char* key, double largest,
                                         std::string_view source) {
  const toml::node* node = table.get(key);
  const auto* array = node != nullptr ? node->as_array() : nullptr;
  std::vector<double> out;
  if (array != nullptr) {
    for (const auto& element : *array) {
      const auto value = element.value<double>();
      if (!value || !(std::abs(*value) <= largest)) {
        return fail(ErrorCode::kInvalidFormat,
                    fmt::format("{}: depth.{} must be numbers between -{} and {}",
                                toml_place(element, source), key, largest, largest));
      }
      out.push_back(*value);
    }
  } else if (node != nullptr) {
    return fail(ErrorCode::kInvalidFormat,
                fmt::format("{}: depth.{} must be an array", toml_place(*node, source), key));
  }
  table.erase(key);
  return out;
}

std::string numbers(const std::vector<double>& values, int columns) {
  std::string text = "[";
  for (std::size_t i = 0; i < values.size(); ++i) {
    const bool new_row = i % static_cast<std::size_t>(std::max(1, columns)) == 0;
    text += fmt::format("{}{:.7g},", new_row ? "\n  " : " ", values[i]);
  }
  return text + "\n]";
}

}  // namespace

Result<DepthCalibration> load_depth_calibration(const fs::path& path) {
  SGS_ASSIGN_OR_RETURN(const std::string text, read_file(path));
  return depth_calibration_from_text(text, path.string());
}

Result<DepthCalibration> depth_calibration_from_text(const std::string& text,
                                                     const std::string& source) {
  SGS_ASSIGN_OR_RETURN(toml::table table, parse_toml(text, source));
  if (const auto format = table["format"].value<std::int64_t>(); !format || *format > kFormat) {
    return fail(ErrorCode::kUnsupported,
                format ? fmt::format("{}: format {} is of a later version (this one reads {})",
                                     source, *format, kFormat)
                       : fmt::format("{}: no 'format', so this is no depth calibration", source),
                "calibrate again: `sgs calibrate INPUT -o FILE`");
  }
  DepthCalibration c;
  if (auto* depth = table["depth"].as_table()) {
    SGS_ASSIGN_OR_RETURN(c.offset_per_m,
                         take_numbers(*depth, "offset_per_m", kLargestOffset, source));
    SGS_ASSIGN_OR_RETURN(c.sigma_per_m, take_numbers(*depth, "sigma_per_m", 1e6, source));
  }
  Scalars scalars;
  ParameterList list;
  scalars.declare(list, c);
  SGS_RETURN_IF_ERROR(apply_toml_table(table, source, list));
  const auto nodes = static_cast<std::size_t>(c.grid.size());
  if (!c.camera.valid() || c.offset_per_m.size() != nodes || c.sigma_per_m.size() != nodes) {
    return fail(ErrorCode::kInvalidFormat,
                fmt::format("{}: {} x {} nodes need as many offsets and deviations, there are {} "
                            "and {}",
                            source, c.grid.columns, c.grid.rows, c.offset_per_m.size(),
                            c.sigma_per_m.size()),
                "calibrate again: `sgs calibrate INPUT -o FILE`");
  }
  return c;
}

Status save_depth_calibration(const fs::path& path, const DepthCalibration& c) {
  return write_file(path, depth_calibration_text(c));
}

std::string depth_calibration_text(const DepthCalibration& c) {
  std::string text = fmt::format(
      "# Depth calibration: 1/z_true = 1/z_measured + offset, and where depth lies against "
      "colour.\n"
      "format = {}\n\n[camera]\nfx = {}\nfy = {}\ncx = {}\ncy = {}\nwidth = {}\nheight = {}\n",
      kFormat, c.camera.fx, c.camera.fy, c.camera.cx, c.camera.cy, c.camera.width, c.camera.height);
  text += fmt::format(
      "\n[depth]\ncolumns = {}\nrows = {}\nmean_sigma_per_m = {:.7g}\nshift_u_px = {:.7g}\n"
      "shift_v_px = {:.7g}\nshift_u_sigma_px = {:.7g}\nshift_v_sigma_px = {:.7g}\n"
      "delay_s = {:.7g}\ndelay_sigma_s = {:.7g}\n",
      c.grid.columns, c.grid.rows, c.mean_sigma_per_m, c.shift_px.x(), c.shift_px.y(),
      c.shift_sigma_px.x(), c.shift_sigma_px.y(), c.delay_s, c.delay_sigma_s);
  text +=
      fmt::format("# 1/m, row by row of the image\noffset_per_m = {}\nsigma_per_m = {}\n",
                  numbers(c.offset_per_m, c.grid.columns), numbers(c.sigma_per_m, c.grid.columns));
  return text;
}

}  // namespace sgs::io
