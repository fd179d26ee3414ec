// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
import net from "node:net";

const kWidth = 320;
const kHeight = 240;
const kFocal = 270;
const kPeriod_ms = 50;
/// Half the sides of the room, metres; x right, y down, z forward.
const kRoom = [2.2, 1.4, 2.6];

/// Smooth patches of grey, the same wherever one looks from.
function texture(u, v) {
  const wave = Math.sin(7 * u + 3 * Math.sin(2.3 * v)) * Math.sin(6 * v + 2 * Math.sin(3.1 * u));
  return 0.5 + 0.25 * wave + 0.2 * Math.sign(Math.sin(11 * u) * Math.sin(9 * v));
}

/// The corner of a room from `place`, turned by `yaw`: rows of r g b, and of millimetres.
function picture(place, yaw) {
  const color = Buffer.alloc(kWidth * kHeight * 3);
  const depth = Buffer.alloc(kWidth * kHeight * 2);
  const [c, s] = [Math.cos(yaw), Math.sin(yaw)];
  for (let v = 0, i = 0; v < kHeight; ++v) {
    for (let u = 0; u < kWidth; ++u, ++i) {
      const [x, y] = [(u - kWidth / 2 + 0.5) / kFocal, (v - kHeight / 2 + 0.5) / kFocal];
      const ray = [c * x + s, y, c - s * x];
      const ways = ray.map((r, k) => (Math.sign(r) * kRoom[k] - place[k]) / r);
      const z = Math.min(...ways);
      const wall = ways.indexOf(z);
      const hit = ray.map((r, k) => place[k] + z * r);
      const [a, b] = [hit[(wall + 1) % 3], hit[(wall + 2) % 3]];
      const tone = Math.round(255 * Math.min(1, Math.max(0, texture(a + 5 * wall, b))));
      color[3 * i] = tone;
      color[3 * i + 1] = (tone * (3 + wall)) / 5;
      color[3 * i + 2] = 255 - tone;
      depth.writeUInt16LE(Math.round(1000 * z), 2 * i);
    }
  }
  return { color, depth };
}

function part(mark, header, ...data) {
  const text = Buffer.from(JSON.stringify(header));
  const length = Buffer.alloc(4);
  length.writeUInt32LE(text.length);
  return Buffer.concat([Buffer.from(mark), length, text, ...data]);
}

/// A camera in somebody's hand, for `sgs run live:tcp://127.0.0.1:PORT`: it delivers until it is
/// stopped. `light` and `surface` can be taken away; `sent` counts frames.
export class FakeCamera {
  light = true;
  surface = true;
  sent = 0;

  constructor(t, port) {
    this.port = port;
    this.connect();
    t.after(() => this.stop());
  }

  connect() {
    this.socket = net.connect(this.port, "127.0.0.1");
    const lens = { width: kWidth, height: kHeight, fx: kFocal, fy: kFocal };
    const camera = { ...lens, cx: kWidth / 2 - 0.5, cy: kHeight / 2 - 0.5 };
    this.socket.on("error", () => {});
    this.socket.on("connect", () =>
      this.socket.write(part("SGS1", { camera, depth: "u16", name: "hand" })),
    );
    clearInterval(this.timer);
    this.timer = setInterval(() => this.deliver(), kPeriod_ms);
  }

  deliver() {
    // What the program does not take is not made.
    if (this.socket.connecting || this.socket.destroyed || this.socket.writableLength > 0) return;
    const k = this.sent++;
    const place = [0.25 * Math.sin(k / 23), 0.1 * Math.sin(k / 31), 0.2 * Math.sin(k / 41)];
    const { color, depth } = picture(place, 0.7 + 0.1 * Math.sin(k / 29));
    if (!this.light) color.fill(0);
    if (!this.surface) depth.fill(0);
    const header = {
      t: 100 + (k * kPeriod_ms) / 1000,
      color_bytes: color.length,
      depth_bytes: depth.length,
    };
    this.socket.write(part("F", header, color, depth));
  }

  stop() {
    clearInterval(this.timer);
    this.socket.destroy();
  }
}
