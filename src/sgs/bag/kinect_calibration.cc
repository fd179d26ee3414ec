// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/bag/kinect_calibration.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <vector>

#include "sgs/bag/messages.h"
#include "sgs/io/json_file.h"

namespace sgs::bag {
namespace {

using Json = nlohmann::json;

constexpr const char* kNeeded =
    "CalibrationInformation with the two Cameras, as the camera's recorder writes it";

/// What a mode shows: the whole sensor is `width` x `height` of its pixels, of which the picture
/// begins at `left`, `top`.
struct Window {
  double width = 0, height = 0, left = 0, top = 0;
};

/// A camera in parts of its sensor's sides, from the corner of the first pixel.
struct UnitCamera {
  double fx = 0, fy = 0, cx = 0, cy = 0;
  Distortion distortion;
  double sensor_width = 0, sensor_height = 0;
  SE3 T_camera_world;
};

/// Pixel centres are at whole numbers.
Result<LensCamera> seen_through(const UnitCamera& c, const Window& w, int width, int height) {
  constexpr double kCentre = 0.5;
  const PinholeCamera camera{width,
                             height,
                             c.fx * w.width,
                             c.fy * w.height,
                             c.cx * w.width - w.left - kCentre,
                             c.cy * w.height - w.top - kCentre};
  if (camera.valid()) return LensCamera{camera, c.distortion};
  return fail(ErrorCode::kInvalidFormat,
              fmt::format("a camera of fx {} fy {} cx {} cy {}", c.fx, c.fy, c.cx, c.cy), kNeeded);
}

/// Rotation by rows and metres.
Result<SE3> transform_of(const Json& rt) {
  const auto rotation = rt.at("Rotation").get<std::array<double, 9>>();
  const auto translation = rt.at("Translation").get<std::array<double, 3>>();
  std::array<double, 12> numbers{};
  std::copy(rotation.begin(), rotation.end(), numbers.begin());
  std::copy(translation.begin(), translation.end(), numbers.begin() + 9);
  return rigid_from_numbers(numbers, RotationOrder::kRows);
}

Result<UnitCamera> unit_camera(const Json& json) {
  enum Parameter { kCx, kCy, kFx, kFy, kK1, kK2, kK3, kK4, kK5, kK6, kCodx, kCody, kP2, kP1, kAll };
  const Json& intrinsics = json.at("Intrinsics");
  const auto model = intrinsics.at("ModelType").get<std::string>();
  // The older of the two is of prototypes: its centre of distortion, which lies within a thousandth
  // of the axis, is left out.
  if (!model.ends_with("BrownConrady") && !model.ends_with("Rational6KT")) {
    return fail(ErrorCode::kUnsupported, fmt::format("a lens of the model {}", model), kNeeded);
  }
  const auto p = intrinsics.at("ModelParameters").get<std::vector<double>>();
  if (p.size() < kAll) {
    return fail(
        ErrorCode::kInvalidFormat,
        fmt::format("{} numbers of a lens, where {} are needed", p.size(), static_cast<int>(kAll)),
        kNeeded);
  }
  UnitCamera out;
  out.fx = p[kFx];
  out.fy = p[kFy];
  out.cx = p[kCx];
  out.cy = p[kCy];
  const std::array<double, 8> in_order = {p[kK1], p[kK2], p[kP1], p[kP2],
                                          p[kK3], p[kK4], p[kK5], p[kK6]};
  out.distortion = Distortion::from_coefficients(in_order).value_or(Distortion{});
  out.sensor_width = json.at("SensorWidth").get<double>();
  out.sensor_height = json.at("SensorHeight").get<double>();
  SGS_ASSIGN_OR_RETURN(out.T_camera_world, transform_of(json.at("Rt")));
  return out;
}

Result<const Json*> of_kind(const Json& list, const char* key, const std::string& value) {
  for (const Json& entry : list) {
    if (entry.at(key).get<std::string>() == value) return &entry;
  }
  return fail(ErrorCode::kInvalidFormat, fmt::format("no {} {}", key, value), kNeeded);
}

tl::unexpected<Error> unknown_size(const char* which, int width, int height) {
  return fail(ErrorCode::kUnsupported,
              fmt::format("says nothing of {} of {}x{}", which, width, height),
              "record in one of the camera's modes");
}

Result<LensCamera> depth_lens(const UnitCamera& unit, int width, int height) {
  struct Mode {
    int width, height;
    Window window;
  };
  constexpr Mode kModes[] = {{640, 576, {1024, 1024, 192, 180}},  // narrow
                             {320, 288, {512, 512, 96, 90}},
                             {1024, 1024, {1024, 1024, 0, 0}},  // wide
                             {512, 512, {512, 512, 0, 0}}};
  for (const Mode& mode : kModes) {
    if (mode.width != width || mode.height != height) continue;
    if (unit.sensor_width != unit.sensor_height) break;
    return seen_through(unit, mode.window, width, height);
  }
  return unknown_size("depth", width, height);
}

/// Calibrations are of the whole sensor, 4:3; early ones of the 16:9 in its middle.
Result<LensCamera> color_lens(UnitCamera unit, int width, int height) {
  const auto is = [](double w, double h, int across, int down) {
    return h > 0 && w * down == h * across;
  };
  const bool whole = is(width, height, 4, 3), middle = is(width, height, 16, 9);
  const bool of_middle = is(unit.sensor_width, unit.sensor_height, 16, 9);
  if ((!whole && !middle) || (!of_middle && !is(unit.sensor_width, unit.sensor_height, 4, 3))) {
    return unknown_size("colour", width, height);
  }
  // Of the sensor's height: 3/4 is what 16:9 of its width are, an eighth lies above it.
  constexpr double kMiddle = 3.0 / 4, kAbove = 1.0 / 8;
  if (of_middle) {
    unit.fy *= kMiddle;
    unit.cy = unit.cy * kMiddle + kAbove;
  }
  const double all = middle ? height / kMiddle : height;
  const Window window{static_cast<double>(width), all, 0, (all - height) / 2};
  return seen_through(unit, window, width, height);
}

/// Frames can be read without: what is wrong here costs the inertial unit alone.
std::optional<KinectCalibration::Inertial> inertial_of(const Json& information,
                                                       const SE3& T_color_world) {
  constexpr const char* kType = "CALIBRATION_InertialSensorType_";
  try {
    const Json& sensors = information.at("InertialSensors");
    const auto of = [&](const char* which) -> Result<SE3> {
      SGS_ASSIGN_OR_RETURN(const Json* sensor,
                           of_kind(sensors, "SensorType", std::string(kType) + which));
      return transform_of(sensor->at("Rt"));
    };
    const auto accelerometer = of("Accelerometer"), gyroscope = of("Gyro");
    if (!accelerometer || !gyroscope) return std::nullopt;
    return KinectCalibration::Inertial{T_color_world * accelerometer->inverse(),
                                       accelerometer->R * gyroscope->R.transpose()};
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

Result<KinectCalibration> calibration_of(const Json& json, const KinectSizes& sizes) {
  constexpr const char* kLocation = "CALIBRATION_CameraLocation";
  const Json& information = json.at("CalibrationInformation");
  const Json& cameras = information.at("Cameras");
  const auto camera = [&](const char* which) -> Result<UnitCamera> {
    SGS_ASSIGN_OR_RETURN(const Json* json_camera,
                         of_kind(cameras, "Location", std::string(kLocation) + which));
    return unit_camera(*json_camera);
  };
  SGS_ASSIGN_OR_RETURN(const UnitCamera depth, camera("D0"));
  SGS_ASSIGN_OR_RETURN(const UnitCamera color, camera("PV0"));
  KinectCalibration out;
  SGS_ASSIGN_OR_RETURN(out.depth, depth_lens(depth, sizes.depth_width, sizes.depth_height));
  SGS_ASSIGN_OR_RETURN(out.color, color_lens(color, sizes.color_width, sizes.color_height));
  out.T_color_depth = color.T_camera_world * depth.T_camera_world.inverse();
  out.inertial = inertial_of(information, color.T_camera_world);
  return out;
}

}  // namespace

Result<KinectCalibration> read_kinect_calibration(std::string_view json, const std::string& name,
                                                  const KinectSizes& sizes) {
  while (json.ends_with('\0')) json.remove_suffix(1);  // as the library hands it out
  SGS_ASSIGN_OR_RETURN(const Json read, io::parse_json(json, name));
  auto calibration = io::read_json(name, kNeeded, [&] { return calibration_of(read, sizes); });
  if (!calibration && !calibration.error().message.starts_with(name)) {
    Error error = std::move(calibration.error());
    error.message = fmt::format("{}: {}", name, error.message);
    return tl::unexpected<Error>(std::move(error));
  }
  return calibration;
}

}  // namespace sgs::bag
