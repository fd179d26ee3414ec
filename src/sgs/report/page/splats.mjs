// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
import { dot } from "./vec.mjs";

/** @import { Three } from "./vec.mjs" */

/** Floats of one record (io/splat_file.h); its first three are the centre. */
export const kRecord = 8;
const kBins = 65536;

/**
 * Puts records into an order, farthest from `eye` along `forward` first: a counting sort over 65536
 * steps of depth, so that few records of nearly the same depth may be out of order.
 *
 * @type {(records: Float32Array, eye: Three, forward: Three, order: Uint32Array) => void}
 */
export function orderByDepth(records, eye, forward, order) {
  const count = order.length;
  const offset = dot(forward, eye);
  const depths = new Float32Array(count);
  let near = Infinity;
  let far = -Infinity;
  for (let i = 0; i < count; ++i) {
    const at = kRecord * i;
    const d =
      forward[0] * records[at] +
      forward[1] * records[at + 1] +
      forward[2] * records[at + 2] -
      offset;
    depths[i] = d;
    if (depths[i] < near) near = depths[i];
    if (depths[i] > far) far = depths[i];
  }
  const scale = (kBins - 1) / Math.max(1e-9, far - near);
  const bins = new Uint32Array(kBins + 1);
  for (let i = 0; i < count; ++i) ++bins[1 + (((far - depths[i]) * scale) | 0)];
  for (let b = 1; b < bins.length; ++b) bins[b] += bins[b - 1];
  for (let i = 0; i < count; ++i) order[bins[((far - depths[i]) * scale) | 0]++] = i;
}

/**
 * Median of what `value` gives for the records, undefined ones left out; about `samples` are asked.
 *
 * @type {(records: Float32Array, samples: number, value: (at: number) => number | undefined) => number | undefined}
 */
export function medianOf(records, samples, value) {
  const count = records.length / kRecord;
  const step = Math.max(1, Math.floor(count / samples));
  const values = [];
  for (let i = 0; i < count; i += step) {
    const one = value(kRecord * i);
    if (one !== undefined) values.push(one);
  }
  return values.sort((a, b) => a - b)[values.length >> 1];
}
