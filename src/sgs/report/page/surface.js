// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
'use strict';
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) =>
  [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = a => a.map(v => v / Math.hypot(...a));
const mix = (...terms) => [0, 1, 2].map(k => terms.reduce((s, [w, a]) => s + w * a[k], 0));

function decodePoints(p) {
  const bytes = Uint8Array.from(atob(p.data), c => c.charCodeAt(0));
  const words = new Uint16Array(bytes.buffer, 0, 3 * p.count);
  const xyz = Float32Array.from(words, (v, i) => p.low[i % 3] + v * p.step);
  const longest = Float32Array.from(bytes.subarray(9 * p.count, 10 * p.count),
    v => p.shortest_axis * Math.exp(v / p.axis_steps) / 127);
  const axes = Float32Array.from(new Int8Array(bytes.buffer, 10 * p.count),
    (v, i) => v * longest[Math.floor(i / 6)]);
  return {count: p.count, xyz, axes, rgb: bytes.subarray(6 * p.count)};
}

// For each disc, its normal on the side that was seen and the way to the nearest of the cameras at
// `path`, both unit vectors.
function sides(points, path) {
  const step = 3 * Math.ceil(path.length / 300), out = new Float32Array(6 * points.count);
  for (let i = 0; i < points.count; ++i) {
    const at = points.xyz.subarray(3 * i, 3 * i + 3);
    let best = Infinity, way = [0, 0, 0];
    for (let k = 0; k < path.length; k += step) {
      const d = [path[k] - at[0], path[k + 1] - at[1], path[k + 2] - at[2]], far = dot(d, d);
      if (far < best) [best, way] = [far, d];
    }
    const n = cross(points.axes.subarray(6 * i, 6 * i + 3), points.axes.subarray(6 * i + 3, 6 * i + 6));
    out.set(unit(dot(n, way) < 0 ? n.map(v => -v) : n), 6 * i);
    out.set(unit(way), 6 * i + 3);
  }
  return out;
}

// The map as a surface of discs around cameras at `path`, in a scene of half diagonal `size`.
function makeSurface(encoded, path, size) {
  const points = decodePoints(encoded), side = sides(points, path);

  // Whether disc i turns its back to what looks at it along -`way`. The more the cameras stood on the
  // other side, the more squarely it has to face: normals of single Gaussians are rough.
  const behind = (i, way) => dot(way, side.subarray(6 * i, 6 * i + 3)) +
    Math.min(0, dot(way, side.subarray(6 * i + 3, 6 * i + 6))) < 0;

  // The disc that point i of the map is on the screen: centre, depth, bounds, and what takes an
  // offset from the centre to steps along the two axes, standard deviations (affine, as in EWA
  // splatting) - or null where it is out of view or seen from behind, so that one looks into rooms.
  function disc(cam, i) {
    const at = points.xyz.subarray(3 * i, 3 * i + 3), p = cam.project(at);
    if (!p || behind(i, unit(mix([1, cam.eye], [-1, at])))) return null;
    // A single Gaussian far away can be as large as a wall.
    const widest = Math.hypot(...points.axes.subarray(6 * i, 6 * i + 3));
    const shrink = Math.min(1, 0.03 * size / widest), near = cam.focal / p[2];
    const [a, b] = [0, 3].map(k => {
      const axis = points.axes.subarray(6 * i + k, 6 * i + k + 3).map(v => shrink * v);
      const z = -dot(axis, cam.back);
      return [near * dot(axis, cam.right) - (p[0] - cam.w / 2) * z / p[2],
        -near * dot(axis, cam.up) - (p[1] - cam.h / 2) * z / p[2], z];
    });
    // A disc seen edge-on is still a line of a pixel's width.
    let det = a[0] * b[1] - a[1] * b[0];
    if (Math.abs(det) <= 0.4 * Math.hypot(a[0], a[1], b[0], b[1])) {
      const [u, v] = Math.hypot(a[0], a[1]) > Math.hypot(b[0], b[1]) ? [a, b] : [b, a];
      const length = Math.hypot(u[0], u[1]);
      if (length < 0.4) [u[0], u[1], v[0], v[1]] = [0.4, 0, 0, 0.4];
      else [v[0], v[1]] = [-0.4 * u[1] / length, 0.4 * u[0] / length];
      det = a[0] * b[1] - a[1] * b[0];
    }
    return {x: p[0], y: p[1], z: p[2], za: a[2], zb: b[2],
      dx: Math.hypot(a[0], b[0]), dy: Math.hypot(a[1], b[1]),
      sx: b[1] / det, sy: -b[0] / det, tx: -a[1] / det, ty: a[0] / det};
  }

  // Calls visit(pixel, depth, squared distance in standard deviations) inside `reach` of them.
  function pixels(d, w, h, reach, visit) {
    const x0 = Math.max(0, Math.ceil(d.x - reach * d.dx)), y0 = Math.max(0, Math.ceil(d.y - reach * d.dy));
    const x1 = Math.min(w - 1, d.x + reach * d.dx), y1 = Math.min(h - 1, d.y + reach * d.dy);
    for (let y = y0; y <= y1; ++y)
      for (let x = x0; x <= x1; ++x) {
        const u = x - d.x, v = y - d.y, s = d.sx * u + d.sy * v, t = d.tx * u + d.ty * v;
        const far = s * s + t * t;
        if (far <= reach * reach) visit(y * w + x, d.z + s * d.za + t * d.zb, far);
      }
  }

  // What is in front blends, as in surface splatting: first the nearest surface, then the mean
  // colour of the discs on it.
  function image(cam) {
    const {w, h} = cam, depth = new Float32Array(w * h).fill(Infinity);
    const discs = [], sum = new Float32Array(4 * w * h);
    for (let i = 0; i < points.count; ++i) {
      const d = discs[i] = disc(cam, i);
      if (d) pixels(d, w, h, 1.8, (k, z) => { if (z < depth[k]) depth[k] = z; });
    }
    const skin = 0.01 * size;
    for (let i = 0; i < points.count; ++i) {
      const d = discs[i], r = points.rgb[3 * i], g = points.rgb[3 * i + 1], b = points.rgb[3 * i + 2];
      if (d) pixels(d, w, h, 2, (k, z, far) => {
        if (z > depth[k] + skin) return;
        const weight = Math.exp(-far);
        sum[4 * k] += weight * r;
        sum[4 * k + 1] += weight * g;
        sum[4 * k + 2] += weight * b;
        sum[4 * k + 3] += weight;
      });
    }
    const picture = new ImageData(w, h);
    for (let k = 0; k < w * h; ++k) {
      if (depth[k] === Infinity) continue;
      for (let c = 0; c < 3; ++c) picture.data[4 * k + c] = sum[4 * k + c] / sum[4 * k + 3];
      picture.data[4 * k + 3] = 255;
    }
    return picture;
  }

  return {count: points.count, image};
}
