// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "sgs/core/error.h"

namespace sgs::bag {

/// Unpacks `packed` ("none" or "", "bz2", "lz4" frames, "zstd"). Memory grows with what comes out,
/// not with what is announced: more than `announced` bytes, or fewer, is an error. The message does
/// not name the file; unknown compressions are kUnsupported.
Result<std::string> unpack(std::string_view compression, std::string_view packed,
                           std::uint64_t announced);

}  // namespace sgs::bag
