// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/upright/upright.h"

#include <fmt/format.h>

#include <cmath>

#include "sgs/core/config.h"
#include "sgs/io/atomic_file.h"
#include "sgs/io/toml_config.h"
#include "sgs/upright/gravity.h"

namespace sgs::run {
namespace {

namespace fs = std::filesystem;

/// The mean upper edge of the pictures; not of length one where the camera rolls about.
Eigen::Vector3d camera_up(const Trajectory& path) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const StampedPose& pose : path.poses()) sum -= pose.T_world_camera.R.col(1);
  return sum / static_cast<double>(path.size());
}

Upright upright_of(UprightBy by, const Eigen::Vector3d& up, const Trajectory& path) {
  return {by, up, upright_turn(up, path.poses().front().T_world_camera.R)};
}

/// What the accelerometer feels as up, turned round where surfaces and camera contradict it.
Eigen::Vector3d checked_by_floor(const dataset::ImuRecording& imu, const Eigen::Vector3d& up,
                                 const Eigen::Vector3d& camera, const std::vector<Patch>& patches,
                                 std::vector<std::string>& warnings) {
  constexpr double kCone_deg = 20, kUpsideDown = -0.5, kMarkedly = 2;
  if (up.dot(camera) > kUpsideDown) return up;
  const auto below = find_level_surfaces(patches, up, kCone_deg);
  const auto above = find_level_surfaces(patches, -up, kCone_deg);
  if (above && above->share > kMarkedly * (below ? below->share : 0)) {
    warnings.push_back(fmt::format(
        "{}: it feels gravity upside down: the floor is seen on the side that it calls up, by a "
        "camera that would hang upside down. It is turned round; an accelerometer at rest should "
        "measure +9.8 m/s2 upwards",
        imu.source));
    return -up;
  }
  warnings.push_back(
      fmt::format("{}: by it the camera hangs upside down{}", imu.source,
                  below ? ""
                        : ", and no floor tells whether that is so; if it is not, change the "
                          "signs of its values"));
  return up;
}

void declare_upright(Upright& upright, int& format, Eigen::Vector4d& q, ParameterList& list) {
  list.add("format", format, "Format of the file.", "", {1, 1});
  list.add("by", upright.by, "By what it is known which way is up.");
  {
    const auto group = list.group("up");
    constexpr const char* kNames[] = {"x", "y", "z"};
    for (int i = 0; i < 3; ++i) {
      list.add(kNames[i], upright.up[i], "Against gravity, in the world of the run.", "", {-1, 1});
    }
  }
  const auto group = list.group("T_upright_world");
  constexpr const char* kNames[] = {"qx", "qy", "qz", "qw"};
  for (int i = 0; i < 4; ++i) {
    list.add(kNames[i], q[i], "Turns the world: z up, x where the first camera looks.", "",
             {-1, 1});
  }
}

}  // namespace

std::string Upright::sentence() const {
  switch (by) {
    case UprightBy::kAccelerometerAndFloor:
      return "upright by the accelerometer and level surfaces";
    case UprightBy::kAccelerometer:
      return "upright by the accelerometer";
    case UprightBy::kFloor:
      return "upright by its floor";
    case UprightBy::kCamera:
      break;
  }
  return "upright as the camera was held on the whole: no accelerometer, and no floor was seen";
}

SE3 upright_turn(const Eigen::Vector3d& up, const Eigen::Matrix3d& R_world_camera) {
  constexpr double kLevel = 0.3;
  const auto level = [&](const Eigen::Vector3d& v) -> Eigen::Vector3d {
    return v - v.dot(up) * up;
  };
  const Eigen::Vector3d ahead = R_world_camera.col(2);
  Eigen::Vector3d x = level(ahead);
  // Looking down, the upper edge lies ahead; looking up, the lower one.
  if (x.norm() < kLevel) x = level((ahead.dot(up) < 0 ? -1 : 1) * R_world_camera.col(1));
  x.normalize();
  SE3 T;
  T.R.row(0) = x;
  T.R.row(1) = up.cross(x);
  T.R.row(2) = up;
  return T;
}

std::optional<Upright> find_upright(const dataset::ImuRecording& imu, const Trajectory& path,
                                    const std::vector<Patch>& patches,
                                    std::vector<std::string>& warnings) {
  constexpr double kHeld_deg = 60;    // how far a hand tilts a camera, on the whole
  constexpr double kCoarse_deg = 10;  // how far an accelerometer that nobody calibrated is off
  if (path.empty()) return std::nullopt;
  Eigen::Vector3d camera = camera_up(path);
  if (!(camera.norm() > 0)) camera = -path.poses().front().T_world_camera.R.col(1);
  camera.normalize();
  if (const auto gravity = estimate_gravity(imu, path, camera, warnings)) {
    const auto up = checked_by_floor(imu, gravity->up, camera, patches, warnings);
    const auto level = find_level_surfaces(patches, up, kCoarse_deg);
    return level ? upright_of(UprightBy::kAccelerometerAndFloor, level->up, path)
                 : upright_of(UprightBy::kAccelerometer, up, path);
  }
  if (const auto level = find_level_surfaces(patches, camera, kHeld_deg)) {
    return upright_of(UprightBy::kFloor, level->up, path);
  }
  return upright_of(UprightBy::kCamera, camera, path);
}

Status save_upright(const fs::path& path, const Upright& upright) {
  Upright copy = upright;  // declaring needs mutable fields
  int format = 1;
  Eigen::Vector4d q = upright.T_upright_world.quaternion().coeffs();
  // What was read is written as it was, in spite of rounding.
  constexpr double kDigits = 1e9;
  for (double& v : q) v = std::round(v * kDigits) / kDigits;
  for (double& v : copy.up) v = std::round(v * kDigits) / kDigits;
  ParameterList list;
  declare_upright(copy, format, q, list);
  return io::write_file(
      path, "# Which way is up in the world of this run (docs/formats.md).\n" + list.to_toml());
}

Result<Upright> load_upright(const fs::path& path) {
  constexpr double kTolerance = 1e-3;
  Upright upright;
  int format = 0;
  Eigen::Vector4d q = Eigen::Vector4d::Zero();
  ParameterList list;
  declare_upright(upright, format, q, list);
  SGS_RETURN_IF_ERROR(io::apply_toml_file(path, list));
  const bool whole =
      std::abs(q.norm() - 1) < kTolerance && std::abs(upright.up.norm() - 1) < kTolerance;
  if (whole) {
    upright.T_upright_world =
        SE3(Eigen::Quaterniond(q[3], q[0], q[1], q[2]), Eigen::Vector3d::Zero());
    upright.up.normalize();
    const Eigen::Vector3d z = upright.T_upright_world.R * upright.up;
    if ((z - Eigen::Vector3d::UnitZ()).norm() < kTolerance) return upright;
  }
  return fail(
      ErrorCode::kInvalidFormat,
      fmt::format("{}: no rotation that turns a direction of length one upwards", path.string()),
      "remove the file: the run is shown as its first camera stood then");
}

}  // namespace sgs::run
