// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "sgs/core/error.h"

namespace sgs::stream {

/// Where a stream comes from or goes to: `live:tcp://HOST:PORT`, `live:PATH` of a pipe, or `live:-`
/// (standard input or output).
struct Address {
  std::string host;  ///< of TCP, an IP address or localhost; empty: a pipe
  unsigned short port = 0;
  std::string path;  ///< of a pipe; "-" = standard input or output
};

/// Whether an input names a stream.
bool is_stream(std::string_view input);
/// An address that cannot be understood is an error that shows the forms there are.
Result<Address> parse_address(std::string_view input);

}  // namespace sgs::stream
