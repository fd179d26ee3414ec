// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "sgs/capture/camera_driver.h"

namespace sgs::cameras {

/// Orbbec's cameras (Gemini 2, 210, 330 and later, Femto Bolt and Mega, Astra 2), through their SDK
/// of version 2, which is looked for when it is needed (ob_library.h).
std::unique_ptr<capture::CameraDriver> make_orbbec_driver();

}  // namespace sgs::cameras
