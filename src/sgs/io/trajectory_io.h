// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include "sgs/core/error.h"
#include "sgs/geometry/trajectory.h"

namespace sgs::io {

/// A trajectory as read from a file, and what had to be put right on the way.
struct LoadedTrajectory {
  Trajectory trajectory;
  std::size_t rows = 0;          ///< rows of the file, comments and blank lines not counted
  std::size_t skipped = 0;       ///< rows with NaN, infinity or a quaternion far from unit length
  std::size_t out_of_order = 0;  ///< rows earlier than the row before them
  std::size_t duplicates = 0;    ///< rows with the time of another row (the first one is kept)
  /// One sentence for a log when anything had to be put right; empty otherwise.
  std::string warning;
};

/// Reads a TUM text trajectory: rows `timestamp tx ty tz qx qy qz qw`, T_world_camera, '#'
/// comments. A row that is not eight numbers is an error that names file and line. Rows with NaN or
/// infinity, or with | |q| - 1 | > 1e-2, are skipped and counted; other quaternions are normalised.
/// The warning, if any, also goes to the log.
Result<LoadedTrajectory> load_trajectory(const std::filesystem::path& path);

/// The same from text; `path` stands for the file's name in messages.
Result<LoadedTrajectory> trajectory_from_text(std::string_view text,
                                              const std::filesystem::path& path);

/// The TUM text of a trajectory: nine digits after the point everywhere, qw >= 0.
std::string trajectory_text(const Trajectory& trajectory);

/// Writes trajectory_text() atomically.
Status save_trajectory(const std::filesystem::path& path, const Trajectory& trajectory);

/// KITTI odometry text: the upper 3x4 of each pose, row by row, no times.
Status save_kitti(const std::filesystem::path& path, const Trajectory& trajectory);

}  // namespace sgs::io
