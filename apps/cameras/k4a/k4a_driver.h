// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "sgs/capture/camera_driver.h"

namespace sgs::cameras {

/// Azure Kinect, and what a library that does as Azure Kinect's reads (Orbbec's for Femto), through
/// libk4a, which is looked for when it is needed (k4a_library.h).
std::unique_ptr<capture::CameraDriver> make_k4a_driver();

}  // namespace sgs::cameras
