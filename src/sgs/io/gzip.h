// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace sgs::io {

/// One gzip member (RFC 1952) holding `bytes`; the same bytes always give the same stream.
std::string gzip_compressed(std::string_view bytes);

/// What a gzip member holds; empty when it is damaged, truncated or larger than `max_bytes`.
std::optional<std::string> gzip_decompressed(std::string_view bytes, std::size_t max_bytes);

/// What a zlib stream (RFC 1950) holds, which must be exactly `size` bytes; empty where it is
/// damaged or holds anything else. Nothing beyond `size` is ever allocated.
std::optional<std::string> zlib_decompressed(std::string_view bytes, std::size_t size);

}  // namespace sgs::io
