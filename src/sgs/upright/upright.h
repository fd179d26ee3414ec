// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sgs/core/enum_names.h"
#include "sgs/core/error.h"
#include "sgs/dataset/imu.h"
#include "sgs/geometry/se3.h"
#include "sgs/geometry/trajectory.h"
#include "sgs/upright/level_surfaces.h"

namespace sgs::run {

/// By what it is known which way is up.
enum class UprightBy {
  kCamera,                 ///< a guess: cameras are held upright on the whole
  kFloor,                  ///< surfaces that lie level
  kAccelerometer,          ///< gravity
  kAccelerometerAndFloor,  ///< gravity, made exact by surfaces that lie level
};
constexpr auto enum_names(UprightBy) {
  using enum UprightBy;
  return std::to_array<EnumName<UprightBy>>({{kCamera, "camera"},
                                             {kFloor, "floor"},
                                             {kAccelerometer, "accelerometer"},
                                             {kAccelerometerAndFloor, "accelerometer_and_floor"}});
}

/// How the world of a run, which is its first camera, stands on the earth. Kept beside the results,
/// which stay in that world.
struct Upright {
  UprightBy by = UprightBy::kCamera;
  Eigen::Vector3d up = -Eigen::Vector3d::UnitY();  ///< unit, against gravity; in the run's world
  /// Turns the world: z up, and the first camera looks along x, as seen from above.
  SE3 T_upright_world;

  /// A sentence for people.
  std::string sentence() const;
};

/// Turns a world in which `up`, a unit vector, is against gravity: z up, and x where a camera of
/// this orientation looks, or, where that is along `up`, its edge that lies ahead.
SE3 upright_turn(const Eigen::Vector3d& up, const Eigen::Matrix3d& R_world_camera);

/// Finds out which way is up along a finished path: from the accelerometer, where there is one that
/// can be used, and from level surfaces near what it says; else from the largest level surfaces
/// below a camera that is held upright on the whole; else from the camera alone. An accelerometer
/// that feels downwards, which surfaces and camera contradict, is turned round. `warnings` gets
/// what was wrong with it. Empty without a path.
std::optional<Upright> find_upright(const dataset::ImuRecording& imu, const Trajectory& path,
                                    const std::vector<Patch>& patches,
                                    std::vector<std::string>& warnings);

/// upright.toml of a run folder.
Status save_upright(const std::filesystem::path& path, const Upright& upright);
/// Errors name the file: unreadable, or no rotation with that direction.
Result<Upright> load_upright(const std::filesystem::path& path);

}  // namespace sgs::run
