// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "sgs/capture/camera_driver.h"

namespace sgs::cameras {

/// Cameras of RealSense's librealsense2 (D400 family, L515, SR300), opened at run time. Tested
/// against a fake library only.
std::unique_ptr<capture::CameraDriver> make_realsense_driver();

}  // namespace sgs::cameras
