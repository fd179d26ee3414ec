// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0

const kFrameRate = 30;
const kTurnStart = 12;
const kTurnFrames = 45;

function multiply([ax, ay, az, aw], [bx, by, bz, bw]) {
  return [
    aw * bx + ax * bw + ay * bz - az * by,
    aw * by - ax * bz + ay * bw + az * bx,
    aw * bz + ax * by - ay * bx + az * bw,
    aw * bw - ax * bx - ay * by - az * bz,
  ];
}

/// A TUM trajectory (world z up) of a camera that looks at what stands along the walls of a room and
/// then turns to the bare floor.
export function turningCamera(frames) {
  const lines = [];
  for (let i = -10; i < frames + 10; ++i) {
    const share = Math.min(1, Math.max(0, (i - kTurnStart) / kTurnFrames));
    const pitch = ((20 + 68 * share * share * (3 - 2 * share)) * Math.PI) / 180;
    const yaw = 0.25 * Math.sin(i / 40);
    const place = [0.15 * Math.sin(i / 30), 0.1 * Math.cos(i / 25), 1.25];
    // Camera looking along world x, then turned down about y and aside about z.
    const level = [-0.5, 0.5, -0.5, 0.5];
    const down = [0, Math.sin(pitch / 2), 0, Math.cos(pitch / 2)];
    const aside = [0, 0, Math.sin(yaw / 2), Math.cos(yaw / 2)];
    const q = multiply(aside, multiply(down, level));
    lines.push([1 + i / kFrameRate, ...place, ...q].map((x) => x.toFixed(6)).join(" "));
  }
  return `${lines.join("\n")}\n`;
}
