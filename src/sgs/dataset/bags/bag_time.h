// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace sgs::dataset {

/// Nanoseconds as seconds: the double nearest to the decimal number, as reading it from text gives.
double seconds_of(std::int64_t nanoseconds);

}  // namespace sgs::dataset
