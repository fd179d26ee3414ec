// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/stream/address.h"

#include <charconv>

namespace sgs::stream {
namespace {

constexpr std::string_view kLive = "live:";
constexpr std::string_view kTcp = "tcp://";
constexpr const char* kForms = "live:tcp://127.0.0.1:PORT, live:PIPE or live:- (standard input)";

}  // namespace

bool is_stream(std::string_view input) { return input.starts_with(kLive); }

Result<Address> parse_address(std::string_view input) {
  const auto bad = [&](const char* what) {
    return fail(ErrorCode::kInvalidArgument, fmt::format("'{}': {}", input, what), kForms);
  };
  if (!is_stream(input)) return bad("no stream");
  std::string_view rest = input.substr(kLive.size());
  Address address;
  if (!rest.starts_with(kTcp)) {
    if (rest.empty()) return bad("names nothing");
    if (rest.find("://") != std::string_view::npos) return bad("this kind of stream is not known");
    address.path = rest;
    return address;
  }
  rest.remove_prefix(kTcp.size());
  const auto colon = rest.rfind(':');
  if (colon == std::string_view::npos || colon == 0) return bad("needs an address and a port");
  address.host = rest.substr(0, colon);
  if (address.host.front() == '[' && address.host.back() == ']') {
    address.host = address.host.substr(1, address.host.size() - 2);
  }
  const std::string_view port = rest.substr(colon + 1);
  const auto parsed = std::from_chars(port.data(), port.data() + port.size(), address.port);
  if (parsed.ec != std::errc{} || parsed.ptr != port.data() + port.size()) {
    return bad("the port must be a number from 0 to 65535");
  }
  return address;
}

}  // namespace sgs::stream
