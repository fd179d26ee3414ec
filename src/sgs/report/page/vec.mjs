// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0

// Vectors in space, for all pages.

/** @typedef {[number, number, number]} Vec */
/** Whatever holds three numbers: a Vec, a part of a list of coordinates. */
/** @typedef {ArrayLike<number>} Three */

/** @type {(a: Three, b: Three) => number} */
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

/** @type {(a: Three, b: Three) => Vec} */
export const cross = (a, b) => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];

/** @type {(a: Three, b: Three) => Vec} */
export const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];

/** @type {(a: Three) => Vec} */
export const unit = (a) => {
  const length = Math.hypot(a[0], a[1], a[2]);
  return [a[0] / length, a[1] / length, a[2] / length];
};

/**
 * The weighted sum of vectors.
 *
 * @type {(...terms: [weight: number, a: Three][]) => Vec}
 */
export const mix = (...terms) => {
  /** @type {Vec} */
  const sum = [0, 0, 0];
  for (const [weight, a] of terms) for (const k of [0, 1, 2]) sum[k] += weight * a[k];
  return sum;
};

/**
 * `v` turned about the unit vector `axis` (formula of Rodrigues).
 *
 * @type {(v: Three, axis: Three, angle: number) => Vec}
 */
export const turned = (v, axis, angle) => {
  const c = Math.cos(angle);
  return mix([c, v], [Math.sin(angle), cross(axis, v)], [dot(axis, v) * (1 - c), axis]);
};

/**
 * Base64 as bytes.
 *
 * @type {(text: string) => Uint8Array<ArrayBuffer>}
 */
export const decoded = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
