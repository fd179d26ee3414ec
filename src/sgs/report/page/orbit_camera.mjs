// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
import { cross, dot, minus, mix, unit } from "./vec.mjs";

/** @import { Three, Vec } from "./vec.mjs" */

/** What the reader turned: angles in radians, 0 looks along -`away`; a pitch of pi/2 looks down. */
/** @typedef {{ yaw: number, pitch: number, zoom: number, pan: Vec }} View */
/** What is looked at: `up`, `across` and `away` are at right angles, units. */
/** @typedef {{ up: Three, across: Three, away: Three, centre: Vec, radius: number }} Subject */
/** `scale` is metres per pixel at the centre; `project` gives pixels and depth, null behind. */
/**
 * @typedef {{
 *   w: number, h: number, eye: Vec, right: Vec, up: Vec, back: Vec, focal: number, scale: number,
 *   project: (p: Three) => Vec | null,
 * }} Camera
 */

/**
 * A camera on a sphere around the subject, for a picture of w by h pixels.
 *
 * @type {(subject: Subject, view: View, w: number, h: number) => Camera}
 */
export function orbitCamera({ up: north, across, away, centre, radius }, view, w, h) {
  const { yaw, pitch } = view;
  const back = mix(
    [-Math.cos(pitch) * Math.cos(yaw), away],
    [Math.cos(pitch) * Math.sin(yaw), across],
    [Math.sin(pitch), north],
  );
  const right = unit(cross(north, back));
  const up = cross(back, right);
  const focal = 1.15 * h;
  const distance = (1.95 * radius) / view.zoom;
  const eye = mix([1, centre], [1, view.pan], [distance, back]);
  return {
    ...{ w, h, eye, right, up, back, focal },
    scale: distance / focal,
    project(p) {
      const d = minus(p, eye);
      const z = -dot(d, back);
      if (z < 0.02 * radius) return null;
      return [w / 2 + (focal * dot(d, right)) / z, h / 2 - (focal * dot(d, up)) / z, z];
    },
  };
}

/**
 * The yaw that looks the way that cameras with these poses (position, then the rotation row by row)
 * looked on the whole; 0 where they looked all around.
 *
 * @type {(subject: Pick<Subject, "across" | "away">, poses: number[][]) => number}
 */
export function yawAlong({ across, away }, poses) {
  const ahead = mix(
    ...poses.map((pose) => /** @type {[number, Vec]} */ ([1, [pose[5], pose[8], pose[11]]])),
  );
  const x = dot(ahead, away);
  const y = -dot(ahead, across);
  return Math.hypot(x, y) < 0.3 * poses.length ? 0 : Math.atan2(y, x);
}
