// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "ob_abi.h"
#include "sgs/geometry/se3.h"
#include "sgs/stream/protocol.h"

// What the library says of its cameras, in our words.
namespace sgs::cameras::ob {

/// A camera with its lens. Inverse Brown-Conrady is taken for Brown-Conrady, with a note.
LensCamera lens_of(const ob_camera_intrinsic& intrinsic, const ob_camera_distortion& distortion,
                   const char* which, std::vector<std::string>& notes);

SE3 transform_of(const ob_extrinsic& extrinsic);

}  // namespace sgs::cameras::ob
