// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <span>

#include "sgs/camera/pinhole.h"
#include "sgs/core/error.h"
#include "sgs/geometry/se3.h"

namespace sgs::dataset {

/// The pose of 12 (3x4) or 16 (4x4) numbers, row by row; empty where they hold NaN or infinity, are
/// no rotation, or are not that many: recordings mark unknown poses so.
std::optional<SE3> rigid_from_rows(std::span<const double> rows);

/// Camera-to-world pose of a camera in OpenGL's axes (x right, y up, looking along -z), which ARKit
/// and nerfstudio use, as one in ours (x right, y down, looking along z).
SE3 from_opengl_camera(const SE3& T_world_opengl);

/// A pose of a world and a camera whose y axes point up where ours point down (left-handed, as
/// renderers have it), mirrored into right-handed ones: the picture stays what it is.
SE3 from_left_handed(const SE3& T);

/// Reads the numbers of a small text file and makes a pose of them; empty as for rigid_from_rows().
/// A file that cannot be read or holds anything but numbers is an error.
Result<std::optional<SE3>> load_pose_matrix(const std::filesystem::path& path);

/// Reads a 3x3 or 4x4 intrinsic matrix, row by row, as a camera without a size.
Result<PinholeCamera> load_intrinsic_matrix(const std::filesystem::path& path);

}  // namespace sgs::dataset
