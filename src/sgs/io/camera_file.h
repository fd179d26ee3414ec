// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "sgs/camera/pinhole.h"
#include "sgs/core/error.h"
#include "sgs/io/calibration_io.h"

namespace sgs::io {

/// The lens model that a name of ROS, Kalibr, OpenCV, COLMAP, ORB-SLAM or RealSense's SDK means
/// ("plumb_bob", "equidistant", "Kannala Brandt4", ...); empty for names that mean neither. No name
/// at all is Brown's.
std::optional<LensModel> lens_model_named(std::string_view name);

/// The lens of that name with coefficients in OpenCV's order. Zeros behind those that the model has
/// are left out of account. Empty where the name or the number of coefficients is not known.
std::optional<Distortion> lens_named(std::string_view name, std::span<const double> coefficients);

/// Reads a camera from YAML or JSON as other programs write it: ROS's camera_info_manager and
/// OpenCV (`camera_matrix`), Kalibr (`cam0`), ORB-SLAM (`Camera.fx`), Open3D (`intrinsic_matrix`),
/// the plain names `fx fy cx cy` (`ppx ppy`) or `K`; or the nine or sixteen numbers of a matrix.
/// What the file does not say is 0: the size of the pictures, the unit of depth. Errors name the
/// file and the forms that are read.
Result<Calibration> load_camera_yaml(const std::filesystem::path& path);

/// What `--camera` takes: numbers (parse_camera_option()), or the name of such a file.
Result<CameraOption> read_camera_option(const std::string& text);

}  // namespace sgs::io
