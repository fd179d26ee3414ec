// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
import { cross, decoded, dot, minus, unit } from "./vec.mjs";

/** @import { Camera } from "./orbit_camera.mjs" */
/** @import { Three, Vec } from "./vec.mjs" */

/** Discs as report/scene.cc packs them. */
/**
 * @typedef {{
 *   count: number, low: Three, step: number, shortest_axis: number, axis_steps: number, data: string,
 * }} PackedDiscs
 */
/** Centres (3 numbers each), the two half axes (6) and colours (3 bytes). */
/** @typedef {{ count: number, xyz: Float32Array, axes: Float32Array, rgb: Uint8Array }} Discs */

/** @type {(p: PackedDiscs) => Discs} */
export function unpackDiscs(p) {
  const bytes = decoded(p.data);
  const words = new Uint16Array(bytes.buffer, 0, 3 * p.count);
  const xyz = Float32Array.from(words, (v, i) => p.low[i % 3] + v * p.step);
  const longest = Float32Array.from(
    bytes.subarray(9 * p.count, 10 * p.count),
    (v) => (p.shortest_axis * Math.exp(v / p.axis_steps)) / 127,
  );
  const axes = Float32Array.from(
    new Int8Array(bytes.buffer, 10 * p.count),
    (v, i) => v * longest[Math.floor(i / 6)],
  );
  return { count: p.count, xyz, axes, rgb: bytes.subarray(6 * p.count) };
}

/**
 * For each disc, its normal on the side that was seen and the way to the nearest of the cameras at
 * `path`, both unit vectors.
 *
 * @type {(discs: Discs, path: number[]) => Float32Array}
 */
export function seenSides(discs, path) {
  const step = 3 * Math.ceil(path.length / 300);
  const out = new Float32Array(6 * discs.count);
  for (let i = 0; i < discs.count; ++i) {
    const at = discs.xyz.subarray(3 * i, 3 * i + 3);
    let best = Infinity;
    /** @type {Vec} */
    let way = [0, 0, 0];
    for (let k = 0; k < path.length; k += step) {
      /** @type {Vec} */
      const d = [path[k] - at[0], path[k + 1] - at[1], path[k + 2] - at[2]];
      const far = dot(d, d);
      if (far < best) [best, way] = [far, d];
    }
    const axes = discs.axes.subarray(6 * i, 6 * i + 6);
    const n = cross(axes.subarray(0, 3), axes.subarray(3, 6));
    out.set(unit(dot(n, way) < 0 ? minus([0, 0, 0], n) : n), 6 * i);
    out.set(unit(way), 6 * i + 3);
  }
  return out;
}

/** A disc on the screen: centre, depth and its slopes, bounds, and what takes an offset from the
 * centre to steps along the two axes. */
/**
 * @typedef {{
 *   x: number, y: number, z: number, za: number, zb: number, dx: number, dy: number,
 *   sx: number, sy: number, tx: number, ty: number,
 * }} ScreenDisc
 */

/**
 * The disc with centre `at` and half `axes` (standard deviations) on the screen (affine, as in EWA
 * splatting), or null where it is out of view. None is wider than `widest`: a single Gaussian far
 * away can be as large as a wall.
 *
 * @type {(cam: Camera, at: Three, axes: Float32Array, widest: number) => ScreenDisc | null}
 */
export function screenDisc(cam, at, axes, widest) {
  const p = cam.project(at);
  if (!p) return null;
  const shrink = Math.min(1, widest / Math.hypot(...axes));
  const near = cam.focal / p[2];
  const [a, b] = [0, 3].map((k) => {
    const axis = axes.subarray(k, k + 3).map((v) => shrink * v);
    const z = -dot(axis, cam.back);
    return [
      near * dot(axis, cam.right) - ((p[0] - cam.w / 2) * z) / p[2],
      -near * dot(axis, cam.up) - ((p[1] - cam.h / 2) * z) / p[2],
      z,
    ];
  });
  // A disc seen edge-on is still a line of a pixel's width.
  let det = a[0] * b[1] - a[1] * b[0];
  if (Math.abs(det) <= 0.4 * Math.hypot(a[0], a[1], b[0], b[1])) {
    const [u, v] = Math.hypot(a[0], a[1]) > Math.hypot(b[0], b[1]) ? [a, b] : [b, a];
    const length = Math.hypot(u[0], u[1]);
    if (length < 0.4) [u[0], u[1], v[0], v[1]] = [0.4, 0, 0, 0.4];
    else [v[0], v[1]] = [(-0.4 * u[1]) / length, (0.4 * u[0]) / length];
    det = a[0] * b[1] - a[1] * b[0];
  }
  return {
    ...{ x: p[0], y: p[1], z: p[2], za: a[2], zb: b[2] },
    ...{ dx: Math.hypot(a[0], b[0]), dy: Math.hypot(a[1], b[1]) },
    ...{ sx: b[1] / det, sy: -b[0] / det, tx: -a[1] / det, ty: a[0] / det },
  };
}

/**
 * Calls visit(pixel, depth, squared distance in standard deviations) inside `reach` of them.
 *
 * @type {(d: ScreenDisc, w: number, h: number, reach: number,
 *   visit: (pixel: number, depth: number, far: number) => void) => void}
 */
function visitPixels(d, w, h, reach, visit) {
  const x0 = Math.max(0, Math.ceil(d.x - reach * d.dx));
  const y0 = Math.max(0, Math.ceil(d.y - reach * d.dy));
  const x1 = Math.min(w - 1, d.x + reach * d.dx);
  const y1 = Math.min(h - 1, d.y + reach * d.dy);
  for (let y = y0; y <= y1; ++y)
    for (let x = x0; x <= x1; ++x) {
      const u = x - d.x;
      const v = y - d.y;
      const s = d.sx * u + d.sy * v;
      const t = d.tx * u + d.ty * v;
      const far = s * s + t * t;
      if (far <= reach * reach) visit(y * w + x, d.z + s * d.za + t * d.zb, far);
    }
}

/**
 * The map as a surface of discs around cameras at `path`, in a scene of half diagonal `size`.
 *
 * @type {(packed: PackedDiscs, path: number[], size: number) =>
 *   { count: number, image: (cam: Camera) => ImageData }}
 */
export function makeSurface(packed, path, size) {
  const discs = unpackDiscs(packed);
  const sides = seenSides(discs, path);

  // Whether disc i turns its back to what looks at it along -`way`, so that one looks into rooms. The
  // more the cameras stood on the other side, the more squarely it has to face: normals of single
  // Gaussians are rough.
  /** @type {(i: number, way: Vec) => boolean} */
  const behind = (i, way) =>
    dot(way, sides.subarray(6 * i, 6 * i + 3)) +
      Math.min(0, dot(way, sides.subarray(6 * i + 3, 6 * i + 6))) <
    0;

  /** @type {(cam: Camera, i: number) => ScreenDisc | null} */
  function shown(cam, i) {
    const at = discs.xyz.subarray(3 * i, 3 * i + 3);
    if (behind(i, unit(minus(cam.eye, at)))) return null;
    return screenDisc(cam, at, discs.axes.subarray(6 * i, 6 * i + 6), 0.03 * size);
  }

  // What is in front blends, as in surface splatting: first the nearest surface, then the mean
  // colour of the discs on it.
  /** @type {(cam: Camera) => ImageData} */
  function image(cam) {
    const { w, h } = cam;
    const depth = new Float32Array(w * h).fill(Infinity);
    const sum = new Float32Array(4 * w * h);
    const on_screen = Array.from({ length: discs.count }, (_, i) => shown(cam, i));
    for (const d of on_screen) {
      if (!d) continue;
      visitPixels(d, w, h, 1.8, (k, z) => {
        if (z < depth[k]) depth[k] = z;
      });
    }
    const skin = 0.01 * size;
    on_screen.forEach((d, i) => {
      if (!d) return;
      const [r, g, b] = discs.rgb.subarray(3 * i, 3 * i + 3);
      visitPixels(d, w, h, 2, (k, z, far) => {
        if (z > depth[k] + skin) return;
        const weight = Math.exp(-far);
        sum[4 * k] += weight * r;
        sum[4 * k + 1] += weight * g;
        sum[4 * k + 2] += weight * b;
        sum[4 * k + 3] += weight;
      });
    });
    const picture = new ImageData(w, h);
    for (let k = 0; k < w * h; ++k) {
      if (depth[k] === Infinity) continue;
      for (let c = 0; c < 3; ++c) picture.data[4 * k + c] = sum[4 * k + c] / sum[4 * k + 3];
      picture.data[4 * k + 3] = 255;
    }
    return picture;
  }

  return { count: discs.count, image };
}
