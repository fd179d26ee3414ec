// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "sgs/bag/bag.h"
#include "sgs/core/error.h"

namespace sgs::bag {

/// Unpacks `packed` ("none" or "", "bz2", "lz4" frames, "zstd"). Memory grows with what comes out,
/// not with what is announced: more than `announced` bytes, or fewer, is an error. The message does
/// not name the file; unknown compressions are kUnsupported.
Result<std::string> unpack(std::string_view compression, std::string_view packed,
                           std::uint64_t announced);

/// Whether bytes begin as a frame of zstd does (RFC 8878, section 3.1.1). No message of CDR does.
bool is_zstd(std::string_view bytes);

// limit: a message that is packed by itself, unpacked, bytes
inline constexpr std::uint64_t kLargestMessage_bytes = std::uint64_t{256} << 20;

/// Unpacks one frame of zstd that may not say how long it is, to kLargestMessage_bytes at most.
Result<std::string> unpack_zstd_frame(std::string_view packed);

/// A message as it was published: recorders may pack each by itself (rosbag2's compression mode
/// "message", RealSense's SDK), which a CDR message shows by how it begins.
Result<std::string> message_content(std::string_view stored, Encoding encoding);

}  // namespace sgs::bag
