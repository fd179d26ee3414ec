// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>

#include "sgs/camera/pinhole.h"
#include "sgs/core/error.h"
#include "sgs/geometry/se3.h"

namespace sgs::bag {

/// The cameras of an Azure Kinect in the modes of a recording.
struct KinectCalibration {
  LensCamera color, depth;
  SE3 T_color_depth;  ///< points of the depth camera into the colour camera, metres
  struct Inertial {
    SE3 T_color_accelerometer;
    Eigen::Matrix3d R_accelerometer_gyroscope;
  };
  std::optional<Inertial> inertial;  ///< empty where the calibration says nothing of the unit
};

/// Sizes of a recording's images, px. They tell the modes: of depth no two have the same.
struct KinectSizes {
  int color_width = 0, color_height = 0;
  int depth_width = 0, depth_height = 0;
};

/// Reads the factory calibration that the recorder attaches to each file, JSON; `name` stands for
/// it in messages. Lenses are given in parts of the whole sensor, from its corner: each mode shows
/// a part of that, scaled (Azure Kinect Sensor SDK, public documentation and headers). Errors: no
/// JSON of this kind (kInvalidFormat), sizes or a lens that these cameras do not have
/// (kUnsupported).
Result<KinectCalibration> read_kinect_calibration(std::string_view json, const std::string& name,
                                                  const KinectSizes& sizes);

}  // namespace sgs::bag
