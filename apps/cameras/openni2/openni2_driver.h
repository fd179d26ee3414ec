// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "sgs/capture/camera_driver.h"

namespace sgs::cameras {

/// What OpenNI2 has drivers for (PrimeSense, Asus Xtion, Structure; others by a maker's own
/// driver), through libOpenNI2, which is looked for when it is needed (openni2_library.h).
std::unique_ptr<capture::CameraDriver> make_openni2_driver();

}  // namespace sgs::cameras
