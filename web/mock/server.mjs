// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// node mock/server.mjs [PORT]: speaks the viewer's protocol with a made-up run (world.mjs), for
// working on the page without building anything else: `npm run mock` beside `npm run dev`. It sends
// no pictures.
import { WebSocketServer } from "ws";
import { gaussian, gaussiansAt, kColumns, kFrames, pose, state } from "./world.mjs";

const kHeaderBytes = 24;
const kRecordBytes = 48;
const kFramePeriod_ms = 33;
const kStatuses = ["ok", "degenerate", "lost"];

function mapDiff(version, from, to, reset) {
  const out = Buffer.alloc(kHeaderBytes + (to - from) * kRecordBytes);
  out.writeUInt8(1, 0);
  out.writeUInt8((reset ? 1 : 0) | 2, 1);
  out.writeBigUInt64LE(BigInt(version), 8);
  out.writeUInt32LE(to - from, 16);
  for (let id = from; id < to; ++id) {
    const at = kHeaderBytes + (id - from) * kRecordBytes;
    const values = gaussian(id);
    out.writeUInt32LE(id, at);
    for (let i = 0; i < 10; ++i) out.writeFloatLE(values[i], at + 4 + 4 * i);
    for (let i = 0; i < 4; ++i)
      out.writeUInt8(Math.max(0, Math.round(values[10 + i])), at + 44 + i);
  }
  return out;
}

function pathChunk(frames) {
  const states = Array.from({ length: frames }, (_, i) => state(i, false));
  return {
    type: "path",
    first: 0,
    estimate: states.map((s) => s.pose),
    truth: states.map((_, i) => pose(i)),
    status: states.map((s) => kStatuses.indexOf(s.status)),
  };
}

/// The made-up run and who watches it.
class Run {
  frame = 0;
  paused = false;
  recording = false;
  clients = new Set();

  constructor() {
    setInterval(() => this.paused || this.advance(), kFramePeriod_ms);
  }

  advance() {
    if (this.frame + 1 >= kFrames) return;
    ++this.frame;
    for (const client of this.clients) this.update(client);
  }

  greet(client) {
    client.send(
      JSON.stringify({
        type: "hello",
        columns: kColumns,
        protocol: 2,
        version: "mock",
        input: "mock:boxes",
        tracker: "spectral",
        preset: "default",
        live: true,
        refines: false,
        session: true,
        records: true,
        starts_again: false,
        camera: { fx: 525, fy: 525, cx: 319.5, cy: 239.5, width: 640, height: 480 },
        up: [0, -1, 0],
        frames_total: kFrames,
        picture_above: 150000,
      }),
    );
    client.send(JSON.stringify(pathChunk(this.frame)));
    client.send(JSON.stringify(this.session()));
    this.update(client);
  }

  session() {
    const recorded = this.recording ? `${this.frame} frames in recording` : "";
    return {
      type: "session",
      at_camera_rate: true,
      dropped: 3,
      left_out: 0,
      camera_fps: 30,
      why_dropped: "tracking takes 41 ms, a frame comes every 33",
      warnings: this.paused ? [] : [{ key: "too_fast", text: "the camera moves too fast" }],
      trouble: "",
      recording: this.recording,
      recorded,
      recording_trouble: "",
      saved: "",
      refinable: this.recording,
      ended: false,
      downloads: [],
    };
  }

  update(client) {
    client.send(JSON.stringify(state(this.frame, this.paused)));
    const wanted = gaussiansAt(this.frame);
    if (client.map !== "none" && wanted !== client.held) {
      client.send(mapDiff(Math.floor(this.frame / 8) + 1, client.held, wanted, client.held === 0));
      client.held = wanted;
    }
    if (this.frame === kFrames - 1) {
      client.send(
        JSON.stringify({
          type: "metrics",
          up: null,
          lines: [
            ["ate_rmse_m", "ATE RMSE", "1.24 cm"],
            ["psnr_db", "PSNR (gsicp)", "27.31 dB"],
          ].map(([key, label, value]) => ({
            key,
            label,
            value,
            group: "",
            meaning: "",
            main: true,
          })),
        }),
      );
    }
  }

  receive(client, message) {
    if (message.type === "subscribe") {
      Object.assign(client, { map: message.map, held: 0 });
    } else if (message.type === "control") {
      if (["pause", "step"].includes(message.action)) this.paused = true;
      if (message.action === "resume") this.paused = false;
      if (message.action === "step") this.advance();
      if (message.action === "record") this.recording = true;
      if (message.action === "stop_recording") this.recording = false;
      client.send(JSON.stringify(this.session()));
    }
    this.update(client);
  }
}

const run = new Run();
const port = Number(process.argv[2] ?? 8091);
new WebSocketServer({ port, host: "127.0.0.1", path: "/ws" }).on("connection", (client) => {
  Object.assign(client, { map: "none", held: 0 });
  run.clients.add(client);
  client.on("close", () => run.clients.delete(client));
  client.on("message", (data) => run.receive(client, JSON.parse(data.toString())));
  run.greet(client);
});
console.log(`made-up run on ws://127.0.0.1:${port}/ws`);
