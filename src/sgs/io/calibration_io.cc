// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/io/calibration_io.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>
#include <vector>

#include "sgs/camera/image_side.h"
#include "sgs/io/atomic_file.h"
#include "sgs/io/text.h"

namespace sgs::io {
namespace fs = std::filesystem;
namespace {

constexpr const char* kCameraTxtForm =
    "one line 'fx fy cx cy width height depth_scale [k1 k2 p1 p2 k3 [k4 k5 k6]]', of a fisheye "
    "'... depth_scale fisheye k1 k2 k3 k4'";

/// All fields as finite numbers, or nothing.
std::optional<std::vector<double>> finite_numbers(const std::vector<std::string_view>& fields) {
  std::vector<double> numbers;
  for (const auto field : fields) {
    const auto value = parse_decimal(field);
    if (!value || !std::isfinite(*value)) return std::nullopt;
    numbers.push_back(*value);
  }
  return numbers;
}

/// A camera as text: so many numbers, and its lens.
struct CameraFields {
  std::vector<double> numbers;
  Distortion lens;
};

/// The first `fixed` fields are numbers; then come none, five or eight of a lens, or "fisheye" and
/// four.
std::optional<CameraFields> camera_fields(std::vector<std::string_view> fields, std::size_t fixed) {
  const bool fisheye =
      fields.size() == fixed + 5 && lower_case(std::string(fields[fixed])) == "fisheye";
  if (fisheye) fields.erase(fields.begin() + static_cast<std::ptrdiff_t>(fixed));
  auto n = finite_numbers(fields);
  if (!n) return std::nullopt;
  const bool fits =
      fisheye || n->size() == fixed || n->size() == fixed + 5 || n->size() == fixed + 8;
  if (!fits) return std::nullopt;
  const auto lens = Distortion::from_coefficients(
      std::span(*n).subspan(fixed), fisheye ? LensModel::kFisheye : LensModel::kBrown);
  if (!lens) return std::nullopt;
  n->resize(fixed);
  return CameraFields{std::move(*n), *lens};
}

bool whole(double value) { return value == std::floor(value) && std::abs(value) < 1e9; }

}  // namespace

Result<CameraOption> parse_camera_option(std::string_view text) {
  const auto read = camera_fields(split_fields(text, ","), 4);
  if (!read) {
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("--camera '{}' is no camera and no file", text),
                "give --camera fx,fy,cx,cy or --camera fx,fy,cx,cy,k1,k2,p1,p2,k3[,k4,k5,k6], of a "
                "fisheye --camera fx,fy,cx,cy,fisheye,k1,k2,k3,k4, or a file that ROS, Kalibr or "
                "OpenCV wrote (YAML)");
  }
  const auto& n = read->numbers;
  CameraOption option{n[0], n[1], n[2], n[3], read->lens, 0, 0, 0};
  if (!(option.fx > 0 && option.fy > 0)) {
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("--camera '{}': focal lengths must be positive", text));
  }
  return option;
}

constexpr int kSmallestSide_px = 8;

/// How far from the axis a lens pictures anything at most, normalised; tangential terms left out.
static double largest_pictured_radius(Distortion lens) {
  lens.p1 = lens.p2 = 0;
  const double fold = lens.fold_radius();
  return std::isinf(fold) ? fold : lens.apply({fold, 0}).x();
}

/// Refuses a lens that pictures nothing as far from its axis as the corners of the picture are: the
/// formula folds back before, so that pixels at the rim have no direction. A fit that folds in the
/// last few pixels of the corners, which its target never reached, does no harm: they are not used.
static Status check_fold(const PinholeCamera& k, const Distortion& lens, std::string_view source) {
  constexpr double kCorner = 0.02;  // of the way to it
  const double corner = std::hypot(std::max(k.cx, k.width - 1 - k.cx) / k.fx,
                                   std::max(k.cy, k.height - 1 - k.cy) / k.fy);
  const double largest = largest_pictured_radius(lens);
  if ((1 - kCorner) * corner <= largest) return {};
  return fail(
      ErrorCode::kInvalidFormat,
      fmt::format("camera calibration from {}: the distortion [{}] folds back within the picture: "
                  "it shows nothing farther than {:.0f} px from its centre, and the corners are "
                  "{:.0f} px away",
                  source, fmt::join(lens.written(), ", "), largest * k.fx, corner * k.fx),
      "calibrate with a target that reaches the corners, or with fewer coefficients; numbers of "
      "another model or order are no distortion of this kind: --camera "
      "fx,fy,cx,cy,k1,k2,p1,p2,k3[,k4,k5,k6], of a fisheye --camera "
      "fx,fy,cx,cy,fisheye,k1,k2,k3,k4");
}

Status check_calibration(const Calibration& c, std::string_view source) {
  const auto bad = [&](std::string what) {
    return fail(ErrorCode::kInvalidFormat,
                fmt::format("camera calibration from {}: {}", source, what),
                "correct it there, or give --camera fx,fy,cx,cy[,k1,k2,p1,p2,k3[,k4,k5,k6]] and "
                "--depth-scale S");
  };
  const PinholeCamera& k = c.camera;
  if (k.width <= 0 || k.height <= 0) {
    return bad(fmt::format("image size {}x{} is not positive", k.width, k.height));
  }
  if (k.width < kSmallestSide_px || k.height < kSmallestSide_px) {
    return bad(fmt::format("images of {}x{} pixels hold nothing to track; {} are the least",
                           k.width, k.height, kSmallestSide_px));
  }
  if (!(k.fx > 0 && k.fy > 0 && std::isfinite(k.fx) && std::isfinite(k.fy))) {
    return bad(fmt::format("focal lengths fx={} fy={} must be positive", k.fx, k.fy));
  }
  if (!std::isfinite(k.cx) || !std::isfinite(k.cy)) {
    return bad(fmt::format("principal point cx={} cy={} is not finite", k.cx, k.cy));
  }
  for (const double value : c.distortion.coefficients()) {
    if (!std::isfinite(value)) return bad("distortion is not finite");
  }
  SGS_RETURN_IF_ERROR(check_fold(k, c.distortion, source));
  if (!(c.depth_scale > 0 && std::isfinite(c.depth_scale))) {
    return bad(fmt::format("depth scale {} must be positive (raw units per metre)", c.depth_scale));
  }
  return {};
}

Result<Calibration> load_camera_txt(const fs::path& path) {
  SGS_ASSIGN_OR_RETURN(const std::string content, read_text(path));
  const auto lines = content_lines(content);
  if (lines.size() != 1) {
    return fail(
        ErrorCode::kInvalidFormat,
        fmt::format("{}{}: {} lines where one is needed", path.string(),
                    lines.size() > 1 ? fmt::format(":{}", lines[1].number) : "", lines.size()),
        fmt::format("write {}", kCameraTxtForm));
  }
  auto fields = split_fields(lines[0].text, ",;");
  // With decimal commas there are twice as many.
  for (const std::size_t count : {7, 12, 15}) {
    const auto row = split_row(lines[0].text, count);
    if (row.size() == count) fields = row;
  }
  const auto read = camera_fields(fields, 7);
  if (!read || !whole(read->numbers[4]) || !whole(read->numbers[5])) {
    return fail(ErrorCode::kInvalidFormat,
                fmt::format("{}:{}: '{}' is not a calibration", path.string(), lines[0].number,
                            lines[0].text.substr(0, 120)),
                fmt::format("write {}", kCameraTxtForm));
  }
  const auto& n = read->numbers;
  Calibration c;
  c.camera = {static_cast<int>(n[4]), static_cast<int>(n[5]), n[0], n[1], n[2], n[3]};
  c.depth_scale = n[6];
  c.distortion = read->lens;
  SGS_RETURN_IF_ERROR(check_calibration(c, fmt::format("{}:{}", path.string(), lines[0].number)));
  return c;
}

Status save_camera_txt(const fs::path& path, const Calibration& c) {
  const PinholeCamera& k = c.camera;
  const bool fisheye = c.distortion.is_fisheye();
  std::string text = fmt::format("# fx fy cx cy width height depth_scale {}\n",
                                 fisheye ? "fisheye k1 k2 k3 k4" : "[k1 k2 p1 p2 k3 [k4 k5 k6]]");
  text +=
      fmt::format("{} {} {} {} {} {} {}", k.fx, k.fy, k.cx, k.cy, k.width, k.height, c.depth_scale);
  if (!c.distortion.is_zero()) {
    text += fmt::format("{} {}", fisheye ? " fisheye" : "", fmt::join(c.distortion.written(), " "));
  }
  return write_file(path, text + "\n");
}

Result<Calibration> load_cam_params_json(const fs::path& path) {
  SGS_ASSIGN_OR_RETURN(const std::string content, read_text(path));
  Calibration c;
  try {
    const auto json = nlohmann::json::parse(content);
    const auto& camera = json.at("camera");
    c.camera = {image_side_px(camera.at("w").get<double>()),
                image_side_px(camera.at("h").get<double>()),
                camera.at("fx").get<double>(),
                camera.at("fy").get<double>(),
                camera.at("cx").get<double>(),
                camera.at("cy").get<double>()};
    c.depth_scale = camera.at("scale").get<double>();
  } catch (const nlohmann::json::exception& e) {
    return fail(ErrorCode::kInvalidFormat, fmt::format("{}: {}", path.string(), e.what()),
                R"(needed: {"camera": {"w", "h", "fx", "fy", "cx", "cy", "scale"}})");
  }
  SGS_RETURN_IF_ERROR(check_calibration(c, path.string()));
  return c;
}

}  // namespace sgs::io
