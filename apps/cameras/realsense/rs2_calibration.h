// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "rs2_abi.h"
#include "sgs/core/error.h"
#include "sgs/geometry/se3.h"
#include "sgs/stream/protocol.h"

// What the library says of its cameras, in our words.
namespace sgs::cameras::rs2 {

/// A camera with its lens. Inverse and modified Brown-Conrady are taken for Brown-Conrady, as of
/// bags, with a note; f-theta with coefficients is an error.
Result<LensCamera> lens_of(const rs2_intrinsics& intrinsics, const char* which,
                           std::vector<std::string>& notes);

SE3 transform_of(const rs2_extrinsics& extrinsics);

}  // namespace sgs::cameras::rs2
