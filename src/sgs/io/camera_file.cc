// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/io/camera_file.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "sgs/camera/image_side.h"
#include "sgs/io/text.h"

namespace sgs::io {
namespace fs = std::filesystem;
namespace {

constexpr const char* kForms =
    "a calibration as ROS or OpenCV (camera_matrix), Kalibr (cam0), ORB-SLAM (Camera.fx) or Open3D "
    "(intrinsic_matrix) writes it, fx, fy, cx, cy by these names, and a matrix K of three rows can "
    "be read; or give the numbers: --camera "
    "fx,fy,cx,cy[,k1,k2,p1,p2,k3[,k4,k5,k6]], of a fisheye --camera "
    "fx,fy,cx,cy,fisheye,k1,k2,k3,k4";

/// Small letters and digits only.
std::string plain_name(std::string_view name) {
  std::string plain;
  for (const char c : lower_case(std::string(name))) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) plain.push_back(c);
  }
  return plain;
}

/// What a file says, before it is checked.
struct Found {
  Calibration calibration;
  std::string model;
  std::vector<double> coefficients;
};

/// A number, or the default where there is none.
double number(const YAML::Node& node, double otherwise = 0) {
  return node && node.IsScalar() ? node.as<double>() : otherwise;
}

std::vector<double> numbers(const YAML::Node& node) {
  std::vector<double> out;
  const YAML::Node list = node && node.IsMap() ? node["data"] : node;
  if (!list || !list.IsSequence()) return out;
  for (const YAML::Node& value : list) {
    for (const double inner : value.IsSequence() ? numbers(value) : std::vector{value.as<double>()})
      out.push_back(inner);
  }
  return out;
}

void take_matrix(const std::vector<double>& K, bool by_columns, PinholeCamera& camera) {
  constexpr std::size_t kEntries = 9;
  if (K.size() != kEntries) return;
  camera.fx = K[0];
  camera.fy = K[4];
  camera.cx = by_columns ? K[6] : K[2];
  camera.cy = by_columns ? K[7] : K[5];
}

void take_size(const YAML::Node& width, const YAML::Node& height, PinholeCamera& camera) {
  camera.width = image_side_px(number(width));
  camera.height = image_side_px(number(height));
}

/// ROS's camera_info_manager, and OpenCV's own calibration program, which have nearly the same
/// keys.
Found of_ros(const YAML::Node& file) {
  Found found;
  take_matrix(numbers(file["camera_matrix"]), false, found.calibration.camera);
  take_size(file["image_width"], file["image_height"], found.calibration.camera);
  found.coefficients = numbers(file["distortion_coefficients"]);
  if (const YAML::Node model = file["distortion_model"]) found.model = model.as<std::string>();
  if (number(file["fisheye_model"]) != 0) found.model = "fisheye";
  return found;
}

Found of_kalibr(const YAML::Node& camera) {
  Found found;
  const auto k = numbers(camera["intrinsics"]);
  const bool pinhole =
      !camera["camera_model"] || camera["camera_model"].as<std::string>() == "pinhole";
  if (k.size() == 4 && pinhole) found.calibration.camera = {0, 0, k[0], k[1], k[2], k[3]};
  const YAML::Node size = camera["resolution"];
  if (size && size.IsSequence() && size.size() == 2) {
    take_size(size[0], size[1], found.calibration.camera);
  }
  found.coefficients = numbers(camera["distortion_coeffs"]);
  if (const YAML::Node model = camera["distortion_model"]) found.model = model.as<std::string>();
  return found;
}

/// ORB-SLAM2's keys, and ORB-SLAM3's with a number behind "Camera".
Found of_orb_slam(const YAML::Node& file, const std::string& camera) {
  Found found;
  const auto key = [&](const char* name) { return file[camera + "." + name]; };
  found.calibration.camera = {
      0, 0, number(key("fx")), number(key("fy")), number(key("cx")), number(key("cy"))};
  take_size(file["Camera.width"], file["Camera.height"], found.calibration.camera);
  const std::string type = file["Camera.type"] ? file["Camera.type"].as<std::string>() : "";
  found.model = plain_name(type) == "kannalabrandt8" ? type : "";
  const bool fisheye = !found.model.empty();
  for (const char* name :
       fisheye ? std::array{"k1", "k2", "k3", "k4"} : std::array{"k1", "k2", "p1", "p2"}) {
    found.coefficients.push_back(number(key(name)));
  }
  if (!fisheye) found.coefficients.push_back(number(key("k3")));
  for (const char* name : {"RGBD.DepthMapFactor", "DepthMapFactor"}) {
    if (file[name]) found.calibration.depth_scale = number(file[name]);
  }
  return found;
}

Found of_open3d(const YAML::Node& file) {
  Found found;
  take_matrix(numbers(file["intrinsic_matrix"]), true, found.calibration.camera);
  take_size(file["width"], file["height"], found.calibration.camera);
  if (file["depth_scale"]) found.calibration.depth_scale = number(file["depth_scale"]);
  return found;
}

/// The value of the first key that is there.
YAML::Node first_of(const YAML::Node& file, std::initializer_list<const char*> keys) {
  for (const char* key : keys) {
    if (const YAML::Node value = file[key]) return value;
  }
  return YAML::Node(YAML::NodeType::Undefined);
}

/// A unit of depth that is written either way: less than one is metres per unit, often in single
/// precision.
double units_per_metre(double scale) {
  constexpr double kRounded = 1e-5;
  if (!(scale > 0 && scale < 1)) return scale;
  const double units = 1 / scale, whole = std::round(units);
  return std::abs(units - whole) < kRounded * units ? whole : units;
}

/// What programs of one's own write: the numbers under their names, or the matrix as K.
Found of_plain_names(const YAML::Node& file) {
  for (const char* inner : {"intrinsics", "camera"}) {
    if (file[inner] && file[inner].IsMap() && file[inner]["fx"]) return of_plain_names(file[inner]);
  }
  Found found;
  PinholeCamera& camera = found.calibration.camera;
  camera = {0,
            0,
            number(first_of(file, {"fx"})),
            number(first_of(file, {"fy"})),
            number(first_of(file, {"cx", "ppx"})),
            number(first_of(file, {"cy", "ppy"}))};
  take_matrix(numbers(first_of(file, {"K", "intrinsics", "intrinsic"})), false, camera);
  take_size(first_of(file, {"width", "w", "image_width"}),
            first_of(file, {"height", "h", "image_height"}), camera);
  found.coefficients =
      numbers(first_of(file, {"coeffs", "D", "dist", "distortion", "dist_coeffs"}));
  if (const YAML::Node model = first_of(file, {"model", "distortion_model"})) {
    found.model = model.as<std::string>();
  }
  found.calibration.depth_scale = units_per_metre(number(first_of(file, {"depth_scale", "scale"})));
  return found;
}

/// The matrix K alone, as text: three rows, or four with a column of zeros.
std::optional<Found> of_matrix_text(std::string_view text) {
  auto k = parse_doubles(text, ",;[]");
  if (!k || (k->size() != 9 && k->size() != 16)) return std::nullopt;
  if (k->size() == 16) k->erase(k->begin() + 3), k->erase(k->begin() + 6);
  const auto at = [&](std::size_t i) { return (*k)[i]; };
  if (at(1) != 0 || at(3) != 0 || at(6) != 0 || at(7) != 0 || at(8) != 1) return std::nullopt;
  Found found;
  found.calibration.camera = {0, 0, at(0), at(4), at(2), at(5)};
  return found;
}

/// The first form that the file has.
Found read_any(const YAML::Node& file) {
  if (!file.IsMap()) return {};
  if (file["camera_matrix"]) return of_ros(file);
  if (file["cam0"]) return of_kalibr(file["cam0"]);
  if (file["intrinsics"] && file["intrinsics"].size() == 4 && file["intrinsics"].IsSequence()) {
    return of_kalibr(file);
  }
  if (file["intrinsic_matrix"]) return of_open3d(file);
  for (const char* camera : {"Camera", "Camera1"}) {
    if (file[std::string(camera) + ".fx"]) return of_orb_slam(file, camera);
  }
  return of_plain_names(file);
}

/// The text without the first line of OpenCV's files, "%YAML:1.0", which is none of YAML.
std::string_view without_directive(std::string_view text) {
  if (!text.starts_with('%')) return text;
  const auto end = text.find('\n');
  return end == std::string_view::npos ? std::string_view() : text.substr(end);
}

}  // namespace

std::optional<LensModel> lens_model_named(std::string_view name) {
  constexpr std::array kBrown = {
      "",       "plumbbob", "rationalpolynomial", "radtan",    "radialtangential", "none",
      "opencv", "pinhole",  "perspective",        "fullopencv"};
  constexpr std::array kFisheye = {
      "equidistant",    "fisheye",       "equi", "kannalabrandt", "kannalabrandt4",
      "kannalabrandt8", "opencvfisheye", "kb4",  "pinholeequi"};
  const std::string plain = plain_name(name);
  const auto is_one_of = [&](const auto& names) {
    return std::find(names.begin(), names.end(), plain) != names.end();
  };
  if (is_one_of(kFisheye)) return LensModel::kFisheye;
  const bool brown = is_one_of(kBrown) || plain.find("brown") != std::string::npos;
  return brown ? std::optional(LensModel::kBrown) : std::nullopt;
}

std::optional<Distortion> lens_named(std::string_view name, std::span<const double> coefficients) {
  const auto model = lens_model_named(name);
  if (!model) return std::nullopt;
  // OpenCV's model goes on to 12 and 14 coefficients, and drivers write five or more for each
  // model.
  const std::size_t most = *model == LensModel::kFisheye ? 4 : 8;
  const auto rest = coefficients.subspan(std::min(most, coefficients.size()));
  const bool longer = std::all_of(rest.begin(), rest.end(), [](double v) { return v == 0; });
  if (longer) coefficients = coefficients.first(coefficients.size() - rest.size());
  return Distortion::from_coefficients(coefficients, *model);
}

Result<Calibration> load_camera_yaml(const fs::path& path) {
  constexpr std::int64_t kLargest_bytes = 1 << 20;
  SGS_ASSIGN_OR_RETURN(const std::string text, read_text(path, kLargest_bytes));
  const auto bad = [&](std::string what) {
    return fail(ErrorCode::kInvalidFormat, fmt::format("{}: {}", path.string(), what), kForms);
  };
  Found found;
  try {
    if (auto matrix = of_matrix_text(text)) {
      found = std::move(*matrix);
    } else {
      const YAML::Node file = YAML::Load(std::string(without_directive(text)));
      if (file.IsMap() && file["cam0"] && file["cam1"]) {
        return bad("has several cameras, so it is not clear which is meant; leave that of colour");
      }
      found = read_any(file);
    }
  } catch (const YAML::Exception& e) {
    return bad(e.what());
  }
  const PinholeCamera& k = found.calibration.camera;
  const bool finite =
      std::isfinite(k.fx) && std::isfinite(k.fy) && std::isfinite(k.cx) && std::isfinite(k.cy);
  if (!(finite && k.fx > 0 && k.fy > 0)) return bad("no focal lengths are found in it");
  const auto lens = lens_named(found.model, found.coefficients);
  if (!lens) {
    return bad(fmt::format("lens model '{}' with {} coefficients is not known", found.model,
                           found.coefficients.size()));
  }
  found.calibration.distortion = *lens;
  const double scale = found.calibration.depth_scale;
  if (!(scale >= 0 && std::isfinite(scale))) return bad("its unit of depth is no number above 0");
  return found.calibration;
}

Result<CameraOption> read_camera_option(const std::string& text) {
  std::error_code error;
  if (text.empty() || !fs::is_regular_file(text, error)) return parse_camera_option(text);
  SGS_ASSIGN_OR_RETURN(const Calibration read, load_camera_yaml(text));
  const PinholeCamera& k = read.camera;
  CameraOption option{k.fx, k.fy, k.cx, k.cy, read.distortion};
  option.width = k.width;
  option.height = k.height;
  option.depth_scale = read.depth_scale;
  return option;
}

}  // namespace sgs::io
