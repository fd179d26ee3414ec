// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sgs/viewer/embedded_files.h"

namespace sgs::viewer {

/// What of a request decides about it.
struct RequestFacts {
  std::string_view method, target;
  std::string_view host;                   ///< empty when the header is missing or repeated
  std::optional<std::string_view> origin;  ///< as sent by a browser
  bool upgrade = false;                    ///< asks for a WebSocket
};

/// Where files of the run are, by their names.
inline constexpr std::string_view kDownloads = "/download/";

/// What to do with a request.
struct Verdict {
  int status = 200;                    ///< HTTP status
  bool websocket = false;              ///< accept the upgrade
  std::string_view download = {};      ///< name of a file of the run that is asked for
  const EmbeddedFile* file = nullptr;  ///< to be sent; null with status 200: the health answer
  std::string_view reason;             ///< one sentence for a refused client
};

/// Who may ask under which name. A page of another site must not reach the server through the
/// user's browser: neither by a foreign name that resolves to this machine (DNS rebinding: Host is
/// checked) nor by opening a WebSocket across origins (Origin is checked).
struct HostPolicy {
  std::vector<std::string> extra_names;  ///< allowed besides localhost and addresses
  std::string token = {};  ///< what the target of a WebSocket must carry; empty = nothing

  /// `host` as in the header (name or address, optional port); `local_address` is the numeric
  /// address that the connection arrived at. Any port is fine: tunnels change it.
  bool host_allowed(std::string_view host, std::string_view local_address) const;
  /// Whether the query of `target` is "token=" and the token. Takes as long for any wrong token.
  bool token_allowed(std::string_view target) const;
};

/// A token that nobody can guess: 128 random bits in hexadecimal.
std::string make_token();

/// A WebSocket may come from a page that this server sent (same host and port) or from a program
/// that is no browser (no Origin at all).
bool origin_allowed(std::optional<std::string_view> origin, std::string_view host);

/// The whole decision. Targets are compared byte by byte with the names of the table (a query is
/// cut off); nothing is decoded and no path ever reaches the file system.
Verdict judge(const RequestFacts& request, const HostPolicy& policy, std::string_view local_address,
              std::span<const EmbeddedFile> files);

/// Value of the header of that name for a file called `path`, by its ending.
std::string_view content_type(std::string_view path);

/// Headers that go with every response, "Name: value".
std::span<const std::pair<std::string_view, std::string_view>> security_headers();

}  // namespace sgs::viewer
