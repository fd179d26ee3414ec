// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sgs/core/error.h"
#include "sgs/dataset/frame_list.h"
#include "sgs/dataset/open.h"

namespace sgs::dataset {

/// A calibration and the words for where it came from. The image size may still be 0 x 0 (with
/// --camera): then the first image gives it.
struct FoundCalibration {
  Calibration calibration;
  std::string source;
  bool of_layout = false;        ///< what the layout says of its cameras applies
  std::string unit_source = {};  ///< of the depth's unit
};

/// Looks for the calibration of a sequence: the options, then `sgs.toml`, `camera.txt`,
/// `cam_params.json` in `folders` (in this order), then what the list's layout says, then
/// `camera.yaml` (io/camera_file.h), then, if the folder's name contains freiburg1..3, fr1..3 or
/// rgbd_bonn, or is that of a Replica scene in NICE-SLAM's layout (room0..2, office0..4), the
/// published values of that camera. Nothing found is an error that lists what was tried.
Result<FoundCalibration> find_calibration(const std::vector<std::filesystem::path>& folders,
                                          const FrameList& list, const OpenOptions& options);

}  // namespace sgs::dataset
