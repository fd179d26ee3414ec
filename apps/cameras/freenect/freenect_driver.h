// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "sgs/capture/camera_driver.h"

namespace sgs::cameras {

/// The first Kinect (of the Xbox 360, and for Windows version 1), through libfreenect, which is
/// looked for when it is needed (freenect_library.h).
std::unique_ptr<capture::CameraDriver> make_freenect_driver();

}  // namespace sgs::cameras
