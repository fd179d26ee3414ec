// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Who may come in, and what they may ask for.
#include "harness.h"
#include "sgs/viewer/http_policy.h"
#include "sgs/viewer/messages.h"

namespace {

using namespace sgs;

std::string lower(std::string_view name) {
  std::string out(name);
  for (char& c : out) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return out;
}

/// Lines: target, Host, Origin.
void policy(std::string_view text) {
  const auto line = [&text] {
    const auto end = std::min(text.find('\n'), text.size());
    const auto part = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    return part;
  };
  viewer::RequestFacts facts;
  facts.method = "GET";
  facts.target = line();
  facts.host = line();
  facts.upgrade = true;
  if (const auto origin = line(); !origin.empty()) facts.origin = origin;
  const auto verdict =
      viewer::judge(facts, viewer::HostPolicy{}, "127.0.0.1", viewer::embedded_files());
  if (!verdict.websocket) return;
  const std::string host = lower(facts.host), origin = lower(facts.origin.value_or(""));
  fuzz::require(
      host.starts_with("localhost") || host.starts_with("127.0.0.1") || host.starts_with('['),
      "only this machine's names get a WebSocket");
  fuzz::require(!facts.origin || origin == "http://" + host || origin == "https://" + host,
                "only this server's own pages get a WebSocket");
}

void request(std::string_view text) {
  const auto asked = viewer::parse_request(text);
  if (!asked) return;
  if (const auto* view = std::get_if<viewer::ViewRequest>(&*asked)) {
    fuzz::require(
        view->width > 0 && view->height > 0 && view->width <= 4096 && view->height <= 4096,
        "a view has a size that can be rendered");
    fuzz::require(view->T_world_camera.all_finite(), "a view has a place");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::Choice input(data, size);
  input.number % 2 == 0 ? request(input.rest) : policy(input.rest);
  return 0;
}
