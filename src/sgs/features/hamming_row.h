// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace sgs::features {

/// Hamming distances of the 32-byte descriptor `a` to `count` of them, row after row from `b` on.
void hamming_row(const std::uint8_t* a, const std::uint8_t* b, int count, int* distances);

}  // namespace sgs::features
