// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/viewer/embedded_files.h"

#include <array>

namespace sgs::viewer {
namespace {

// Shows the state as text, so that a build without npm still has something to look at.
constexpr std::string_view kPlaceholderPage = R"html(<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>Spectral GS-SLAM</title>
<meta name="viewport" content="width=device-width, initial-scale=1">
<link rel="icon" href="data:,">
<style>body{font:16px/1.5 sans-serif;max-width:42rem;margin:2rem auto;padding:0 1rem}
code,pre{background:#eee;padding:.1rem .3rem;overflow:auto}</style></head>
<body><h1>Spectral GS-SLAM</h1>
<p>The server runs, but this build has no viewer page: it was built where <code>npm</code> was
missing. Install Node.js and npm (<code>apt-get install nodejs npm</code>), then configure and
build again: <code>cmake --preset release &amp;&amp; cmake --build --preset release</code>.</p>
<p>What the server says meanwhile:</p><pre id="state">connecting ...</pre>
<script src="/placeholder.js"></script></body></html>
)html";

constexpr std::string_view kPlaceholderScript = R"js('use strict';
const out = document.getElementById('state');
const secure = location.protocol === 'https:';
const socket = new WebSocket((secure ? 'wss://' : 'ws://') + location.host + '/ws');
socket.onmessage = (event) => {
  if (typeof event.data !== 'string') return;
  const message = JSON.parse(event.data);
  if (message.type === 'path') return;
  out.textContent = JSON.stringify(message, null, 1);
};
socket.onclose = () => { out.textContent += '\n\nconnection closed'; };
)js";

constexpr std::array<EmbeddedFile, 2> kPlaceholder = {{
    {"index.html", "text/html; charset=utf-8", kPlaceholderPage},
    {"placeholder.js", "text/javascript; charset=utf-8", kPlaceholderScript},
}};

}  // namespace

std::span<const EmbeddedFile> embedded_files() {
  const auto generated = generated_files();
  return generated.empty() ? std::span<const EmbeddedFile>(kPlaceholder) : generated;
}

}  // namespace sgs::viewer
