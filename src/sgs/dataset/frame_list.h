// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sgs/core/error.h"
#include "sgs/geometry/trajectory.h"
#include "sgs/io/calibration_io.h"

namespace sgs::dataset {

/// The files of one frame, and where a reader of the error should look: "rgb.txt:12".
struct FrameEntry {
  double timestamp_s = 0;
  std::filesystem::path color, depth;
  std::string color_origin, depth_origin;
};

/// What a layout reader finds in a folder, before any image is opened.
struct FrameList {
  std::string layout;
  std::string name;
  std::filesystem::path folder;
  std::vector<FrameEntry> frames;  ///< in order of time
  Trajectory truth;
  std::size_t color_without_depth = 0, depth_without_color = 0;
  std::vector<std::string> warnings;
};

/// One reader per layout. Each returns an error when the folder has the layout but cannot be used.
Result<FrameList> list_tum(const std::filesystem::path& folder, double max_time_difference_s);
Result<FrameList> list_replica(const std::filesystem::path& scene);
Result<FrameList> list_folder(const std::filesystem::path& folder, const io::SequenceToml& toml);

/// Whether a folder has the files that mark a layout.
bool looks_like_tum(const std::filesystem::path& folder);
bool looks_like_replica(const std::filesystem::path& scene);

/// Files of a folder whose name matches `pattern` (one '*' at most stands for anything), sorted by
/// name. A missing folder has no files.
std::vector<std::filesystem::path> files_matching(const std::filesystem::path& folder,
                                                  const std::string& pattern);
/// PNG and JPEG files of a folder, sorted by name.
std::vector<std::filesystem::path> image_files(const std::filesystem::path& folder);

/// The last part of a path, also for "." and "a/b/".
std::string folder_name(const std::filesystem::path& folder);

}  // namespace sgs::dataset
