// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "sgs/camera/depth_calibration.h"
#include "sgs/dataset/frame_source.h"

namespace sgs::dataset {

/// The frames of a source with their depth corrected. A calibration of another camera or image size
/// is refused; `name` is what the message calls it.
Result<std::unique_ptr<FrameSource>> calibrated(std::unique_ptr<FrameSource> source,
                                                DepthCalibration calibration,
                                                std::string_view name);

}  // namespace sgs::dataset
