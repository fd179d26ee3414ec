// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "sgs/camera/depth_calibration.h"
#include "sgs/core/error.h"

namespace sgs::io {

/// Reads what save_depth_calibration() wrote (docs/formats.md, calibration.toml). A file of a later
/// format, a grid that does not have its number of values, and values that no depth camera has are
/// errors that name the file.
Result<DepthCalibration> load_depth_calibration(const std::filesystem::path& path);
Status save_depth_calibration(const std::filesystem::path& path, const DepthCalibration& c);

/// The same as text; `source` is what errors call it.
Result<DepthCalibration> depth_calibration_from_text(const std::string& text,
                                                     const std::string& source);
std::string depth_calibration_text(const DepthCalibration& c);

}  // namespace sgs::io
