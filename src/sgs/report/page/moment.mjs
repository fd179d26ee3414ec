// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0

// One moment in time, shown in every plot over time and in the scene.

/** In seconds; null = none. */
/** @typedef {number | null} Moment */

/** @type {((t: Moment) => void)[]} */
const listeners = [];

/** @type {(listener: (t: Moment) => void) => void} */
export const onMoment = (listener) => void listeners.push(listener);

/** @type {(t: Moment) => void} */
export const showMoment = (t) => listeners.forEach((listener) => listener(t));

/** The time axis of a plot: times at both ends, the pixels where they are, top and bottom. */
/** @typedef {{ t0: number, t1: number, left: number, right: number, top: number, bottom: number }} Axis */

/** @type {(text: string) => Axis} */
export function parsedAxis(text) {
  const [t0, t1, left, right, top, bottom] = text.split(" ").map(Number);
  return { t0, t1, left, right, top, bottom };
}

/** @type {(axis: Axis, t: number) => number} */
export const pixelOf = ({ t0, t1, left, right }, t) =>
  left + ((t - t0) / (t1 - t0)) * (right - left);

/** The time at a pixel, at most that at the nearer end. */
/** @type {(axis: Axis, u: number) => number} */
export const timeAt = ({ t0, t1, left, right }, u) =>
  Math.min(t1, Math.max(t0, t0 + ((u - left) / (right - left)) * (t1 - t0)));

/**
 * Index of the first of the ascending `times` that is not before `t`, or else of the last.
 *
 * @type {(times: number[], t: number) => number}
 */
export function indexAt(times, t) {
  const i = times.findIndex((time) => time >= t);
  return i < 0 ? times.length - 1 : i;
}
