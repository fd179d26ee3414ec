// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0

/// A made-up run for working on the page: a camera that circles over a floor with boxes on it, and
/// now and then sees nothing but floor. World: x right, y down, z forward, floor at y = 1.

const kFramesPerTurn = 480;
const kPlainFrames = 140; // of each kFramesPerPhase
const kFramesPerPhase = 240;
export const kFrames = 960;

/// Deterministic numbers in [0, 1).
function hash(n) {
  const x = Math.sin(n * 12.9898 + 78.233) * 43758.5453;
  return x - Math.floor(x);
}

/// Quaternion x y z w of the rotation whose columns are right, down and forward.
function quaternion(r, d, f) {
  const trace = r[0] + d[1] + f[2];
  if (trace > 0) {
    const s = 2 * Math.sqrt(trace + 1);
    return [(d[2] - f[1]) / s, (f[0] - r[2]) / s, (r[1] - d[0]) / s, s / 4];
  }
  if (r[0] > d[1] && r[0] > f[2]) {
    const s = 2 * Math.sqrt(1 + r[0] - d[1] - f[2]);
    return [s / 4, (d[0] + r[1]) / s, (f[0] + r[2]) / s, (d[2] - f[1]) / s];
  }
  if (d[1] > f[2]) {
    const s = 2 * Math.sqrt(1 + d[1] - r[0] - f[2]);
    return [(d[0] + r[1]) / s, s / 4, (f[1] + d[2]) / s, (f[0] - r[2]) / s];
  }
  const s = 2 * Math.sqrt(1 + f[2] - r[0] - d[1]);
  return [(f[0] + r[2]) / s, (f[1] + d[2]) / s, s / 4, (r[1] - d[0]) / s];
}

const cross = (a, b) => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];
const unit = (v) => v.map((x) => x / Math.hypot(...v));

export function isPlain(frame) {
  return frame % kFramesPerPhase >= kFramesPerPhase - kPlainFrames;
}

export function pose(frame, error_m = 0) {
  const angle = (2 * Math.PI * frame) / kFramesPerTurn;
  const place = [
    1.4 * Math.sin(angle) + error_m * Math.sin(frame / 37),
    -0.25 + 0.08 * Math.sin(3 * angle),
    1.4 * Math.cos(angle) + error_m * Math.cos(frame / 23),
  ];
  const target = isPlain(frame) ? [1.9 * Math.sin(angle), 1, 1.9 * Math.cos(angle)] : [0, 0.8, 0];
  const forward = unit(target.map((x, i) => x - place[i]));
  const right = unit(cross([0, 1, 0], forward));
  return [...place, ...quaternion(right, cross(forward, right), forward)];
}

/// Gaussian `id` as [x, y, z, sx, sy, sz, qw, qx, qy, qz, r, g, b, a].
export function gaussian(id) {
  const [u, v, w] = [hash(id), hash(id + 0.3), hash(id + 0.7)];
  if (id % 3 !== 0) {
    const [x, z] = [5 * (u - 0.5), 5 * (v - 0.5)];
    const tile = (Math.floor(x * 2) + Math.floor(z * 2)) & 1 ? 190 : 120;
    return [x, 1, z, 0.03, 0.004, 0.03, 1, 0, 0, 0, tile, tile - 15 * w, tile - 40, 240];
  }
  const box = id % 5;
  const [cx, cz] = [0.55 * Math.cos(box * 1.26), 0.55 * Math.sin(box * 1.26)];
  const half = 0.12 + 0.03 * box;
  const side = Math.floor(w * 3);
  const p = [u - 0.5, v - 0.5, w * 3 - side > 0.5 ? 0.5 : -0.5].map((x) => 2 * half * x);
  const [x, y, z] = side === 0 ? p : side === 1 ? [p[2], p[0], p[1]] : [p[1], -half, p[0]];
  const color = [
    [86, 180, 233],
    [230, 159, 0],
    [0, 158, 115],
    [204, 121, 167],
    [213, 94, 0],
  ][box];
  return [cx + x, 1 - half + y, cz + z, 0.02, 0.02, 0.02, 1, 0, 0, 0, ...color, 240];
}

/// The state message of a frame.
export function state(frame, paused) {
  const plain = isPlain(frame);
  const since = (frame % kFramesPerPhase) - (kFramesPerPhase - kPlainFrames);
  const weak = plain ? Math.min(1, 0.3 + since / 12) : 0;
  const noise = 1 + 0.3 * Math.sin(frame / 5);
  const lost = plain && since > 70 && since < 95;
  // Seen least first; the three weak axes of a plane are mixed, as eigenvectors do.
  const s = Math.SQRT1_2;
  const axes = [
    [0, 0, s, s, 0, 0],
    [0, 0, -s, s, 0, 0],
    [0, 0, 0, 0, 1, 0],
    [1, 0, 0, 0, 0, 0],
    [0, 1, 0, 0, 0, 0],
    [0, 0, 0, 0, 0, 1],
  ];
  return {
    type: "state",
    frame,
    time: frame / 30,
    status: lost ? "lost" : weak > 0.5 ? "degenerate" : "ok",
    lost: lost ? "Neither geometry nor texture shows the motion along one axis." : null,
    pose: pose(frame, 0.012),
    truth: pose(frame),
    map_version: Math.floor(frame / 8) + 1,
    gaussians: gaussiansAt(frame),
    values: {
      index: frame,
      mapping_keyframe: frame % 8 === 0,
      snr: plain ? [0.9, 1.6, 2.4, 800, 1500, 4200] : [38 * noise, 60, 95, 800, 1500, 4200],
      weight: [weak, weak, 0.97 * weak, 0, 0, 0],
      axis: axes,
      degenerate_mask: weak > 0.5 ? 7 : 0,
      condition_number: (plain ? 9000 : 45) * noise,
      planarity: plain ? 0.97 : 0.25 * noise,
      prior_active: weak > 0.5 && !lost,
      prior_source: "photometric",
      track_ms: 6.5 * noise,
    },
    map_ms: 22,
    fps: 29.5,
    paused,
    finished: frame === kFrames - 1,
  };
}

/// What the values are, as hello announces them.
export const kColumns = [
  { key: "index", unit: "", meaning: "Position in the input." },
  { key: "track_ms", unit: "ms", meaning: "CPU time of tracking." },
  { key: "condition_number", unit: "", meaning: "Largest over smallest eigenvalue." },
];

export function gaussiansAt(frame) {
  return Math.min(24000, 3000 + 160 * (Math.floor(frame / 8) + 1));
}
