// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "sgs/core/image.h"

namespace sgs {

/// luma() of each of `width` pixels, to the bit.
void luma_row(const Rgb8* in, float* out, std::size_t width);

}  // namespace sgs
