// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/viewer/http_policy.h"

#include <algorithm>
#include <array>
#include <random>

#include "sgs/core/format.h"

namespace sgs::viewer {
namespace {

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

bool same_name(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](char x, char y) { return lower(x) == lower(y); });
}

bool is_port(std::string_view text) {
  return !text.empty() && text.size() <= 5 &&
         std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

/// The name of "name", "name:port", "[v6]" or "[v6]:port" without brackets; empty when malformed.
std::string_view host_name(std::string_view host) {
  std::string_view name = host, rest;
  if (!host.empty() && host.front() == '[') {
    const auto end = host.find(']');
    if (end == std::string_view::npos) return {};
    name = host.substr(1, end - 1);
    rest = host.substr(end + 1);
  } else if (const auto colon = host.find(':'); colon != std::string_view::npos) {
    name = host.substr(0, colon);
    rest = host.substr(colon);
  }
  if (!rest.empty() && (rest.front() != ':' || !is_port(rest.substr(1)))) return {};
  return name;
}

const EmbeddedFile* find_file(std::span<const EmbeddedFile> files, std::string_view target) {
  target = target.substr(0, target.find('?'));
  if (target.empty() || target.front() != '/') return nullptr;
  target.remove_prefix(1);
  if (target.empty()) target = "index.html";
  return find_embedded(files, target);
}

Verdict refused(int status, std::string_view reason) {
  Verdict verdict;
  verdict.status = status;
  verdict.reason = reason;
  return verdict;
}

constexpr std::string_view kTokenNeeded =
    "The address on the terminal ends in a token: it is needed.";

}  // namespace

bool HostPolicy::host_allowed(std::string_view host, std::string_view local_address) const {
  const std::string_view name = host_name(host);
  if (name.empty()) return false;
  for (const std::string_view own : {"localhost", "127.0.0.1", "::1"}) {
    if (same_name(name, own)) return true;
  }
  return same_name(name, local_address) ||
         std::any_of(extra_names.begin(), extra_names.end(),
                     [&](const std::string& extra) { return same_name(name, extra); });
}

bool HostPolicy::token_allowed(std::string_view target) const {
  constexpr std::string_view kQuery = "?token=";
  if (token.empty()) return true;
  const auto query = target.find('?');
  if (query == std::string_view::npos || !target.substr(query).starts_with(kQuery)) return false;
  const std::string_view given = target.substr(query + kQuery.size());
  unsigned different = given.size() == token.size() ? 0 : 1;
  for (std::size_t i = 0; i < token.size(); ++i) {
    different |= static_cast<unsigned char>(token[i]) ^
                 static_cast<unsigned char>(i < given.size() ? given[i] : 0);
  }
  return different == 0;
}

std::string make_token() {
  constexpr int kWords = 4;
  std::random_device random;  // the system's
  std::string token;
  for (int i = 0; i < kWords; ++i) token += fmt::format("{:08x}", random());
  return token;
}

bool origin_allowed(std::optional<std::string_view> origin, std::string_view host) {
  if (!origin) return true;
  for (const std::string_view scheme : {"http://", "https://"}) {
    if (origin->size() > scheme.size() && same_name(origin->substr(0, scheme.size()), scheme) &&
        same_name(origin->substr(scheme.size()), host)) {
      return true;
    }
  }
  return false;
}

Verdict judge(const RequestFacts& request, const HostPolicy& policy, std::string_view local_address,
              std::span<const EmbeddedFile> files) {
  if (!policy.host_allowed(request.host, local_address)) {
    return refused(403, "This server does not answer to that Host (see --viewer-host).");
  }
  const std::string_view path = request.target.substr(0, request.target.find('?'));
  Verdict verdict;
  if (request.upgrade) {
    if (path != "/ws") return refused(404, "The WebSocket is at /ws.");
    if (!policy.token_allowed(request.target)) return refused(403, kTokenNeeded);
    if (!origin_allowed(request.origin, request.host)) {
      return refused(403, "Pages of other sites may not connect.");
    }
    verdict.status = 101;
    verdict.websocket = true;
    return verdict;
  }
  if (request.method != "GET" && request.method != "HEAD") {
    return refused(405, "Only GET and HEAD.");
  }
  if (request.target == "/healthz") return verdict;
  if (request.target == "/ws") return refused(426, "This is a WebSocket.");
  if (path.starts_with(kDownloads) && path.size() > kDownloads.size()) {
    if (!policy.token_allowed(request.target)) return refused(403, kTokenNeeded);
    verdict.download = path.substr(kDownloads.size());
    return verdict;
  }
  verdict.file = find_file(files, request.target);
  return verdict.file != nullptr ? verdict : refused(404, "There is nothing here.");
}

std::span<const std::pair<std::string_view, std::string_view>> security_headers() {
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 5> kHeaders = {{
      {"Content-Security-Policy",
       "default-src 'self'; script-src 'self' 'wasm-unsafe-eval' blob:; worker-src 'self' blob:; "
       "connect-src 'self' blob: data:; img-src 'self' blob: data:; style-src 'self' "
       "'unsafe-inline'; font-src 'self' data:; base-uri 'none'; form-action 'none'; "
       "frame-ancestors 'none'"},
      {"X-Content-Type-Options", "nosniff"},
      {"Referrer-Policy", "no-referrer"},
      {"Cross-Origin-Resource-Policy", "same-origin"},
      {"Cache-Control", "no-cache"},
  }};
  return kHeaders;
}

std::string_view content_type(std::string_view path) {
  using Row = std::pair<std::string_view, std::string_view>;
  constexpr std::array<Row, 12> kTypes = {{{".html", "text/html; charset=utf-8"},
                                           {".js", "text/javascript; charset=utf-8"},
                                           {".css", "text/css; charset=utf-8"},
                                           {".txt", "text/plain; charset=utf-8"},
                                           {".json", "application/json"},
                                           {".svg", "image/svg+xml"},
                                           {".png", "image/png"},
                                           {".jpg", "image/jpeg"},
                                           {".webp", "image/webp"},
                                           {".ico", "image/x-icon"},
                                           {".wasm", "application/wasm"},
                                           {".woff2", "font/woff2"}}};
  const auto row = std::find_if(kTypes.begin(), kTypes.end(),
                                [&](const Row& type) { return path.ends_with(type.first); });
  return row == kTypes.end() ? "application/octet-stream" : row->second;
}

}  // namespace sgs::viewer
