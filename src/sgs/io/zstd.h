// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace sgs::io {

/// One frame of Zstandard (RFC 8878). Equal bytes give equal frames.
std::string zstd_compressed(std::string_view bytes);

/// What one whole frame holds, if that is `size` bytes; empty otherwise and where it is damaged.
/// Memory grows with what comes out, not with what is announced.
std::optional<std::string> zstd_decompressed(std::string_view frame, std::size_t size);

}  // namespace sgs::io
