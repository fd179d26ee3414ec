// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
"use strict";
const out = document.getElementById("state");
const secure = location.protocol === "https:";
const socket = new WebSocket(
  (secure ? "wss://" : "ws://") + location.host + "/ws" + location.search,
);
socket.onmessage = (event) => {
  if (typeof event.data !== "string") return;
  const message = JSON.parse(event.data);
  if (message.type === "path") return;
  out.textContent = JSON.stringify(message, null, 1);
};
socket.onclose = () => {
  out.textContent += "\n\nconnection closed";
};
