// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// node --test page.test.mjs: what the pages compute.
import assert from "node:assert/strict";
import { test } from "node:test";
import { indexAt, parsedAxis, pixelOf, timeAt } from "./moment.mjs";
import { orbitCamera, yawAlong } from "./orbit_camera.mjs";
import { reading } from "./scene.mjs";
import { medianOf, orderByDepth } from "./splats.mjs";
import { screenDisc, seenSides, unpackDiscs } from "./surface.mjs";
import { cross, dot, mix, turned, unit } from "./vec.mjs";

function assertNear(actual, expected, tolerance = 1e-9) {
  assert.equal(actual.length, expected.length);
  expected.forEach((value, k) =>
    assert.ok(Math.abs(actual[k] - value) <= tolerance, `${actual} is not ${expected}`),
  );
}

const kSubject = {
  up: [0, 0, 1],
  across: [0, 1, 0],
  away: [-1, 0, 0],
  centre: [1, 2, 3],
  radius: 2,
};
const kLevel = { yaw: 0, pitch: 0, zoom: 1, pan: [0, 0, 0] };

test("vectors", () => {
  assert.equal(dot([1, 2, 3], [4, 5, 6]), 32);
  assertNear(cross([1, 0, 0], [0, 1, 0]), [0, 0, 1]);
  assertNear(unit([0, 3, 4]), [0, 0.6, 0.8]);
  assertNear(mix([2, [1, 0, 0]], [-1, [0, 3, 1]]), [2, -3, -1]);
  assertNear(mix(), [0, 0, 0]);
  assertNear(turned([1, 0, 5], [0, 0, 1], Math.PI / 2), [0, 1, 5]);
});

test("the orbit camera looks at its centre from any side", () => {
  for (const view of [kLevel, { ...kLevel, yaw: 2, pitch: -1, zoom: 3 }]) {
    const cam = orbitCamera(kSubject, view, 640, 480);
    assertNear(cam.project(kSubject.centre), [320, 240, (1.95 * 2) / view.zoom]);
    assert.equal(cam.project(mix([2, cam.eye], [-1, kSubject.centre])), null, "what is behind");
    assertNear([dot(cam.right, cam.up), dot(cam.right, cam.back)], [0, 0]);
  }
});

test("on the screen, up is up and a step to the right goes right", () => {
  const cam = orbitCamera(kSubject, kLevel, 640, 480);
  const [u, v] = cam.project(mix([1, kSubject.centre], [0.1, cam.right], [0.1, kSubject.up]));
  assert.ok(u > 320 && v < 240);
  assertNear([u - 320], [0.1 / cam.scale], 1e-9);
});

test("the first view looks as the cameras did, if they agree", () => {
  // Rotation row by row: z, the way a camera looks, is the last column.
  const looking = ([x, y, z]) => [0, 0, 0, 0, 0, x, 0, 0, y, 0, 0, z];
  assert.equal(yawAlong(kSubject, [looking([1, 0, 0]), looking([-1, 0, 0])]), 0);
  const ahead = unit([-1, 1, 0]);
  const yaw = yawAlong(kSubject, [looking(ahead), looking(ahead)]);
  const cam = orbitCamera(kSubject, { ...kLevel, yaw }, 640, 480);
  assertNear(mix([-1, cam.back]), ahead);
});

test("pixels and times of a plot", () => {
  const axis = parsedAxis("10 20 40 240 5 90");
  assert.equal(pixelOf(axis, 15), 140);
  assert.equal(timeAt(axis, 140), 15);
  assert.equal(timeAt(axis, 0), 10);
  assert.equal(timeAt(axis, 1000), 20);
  assert.deepEqual([axis.top, axis.bottom], [5, 90]);
  assert.deepEqual(
    [0, 1, 1.5, 9].map((t) => indexAt([1, 2, 3], t)),
    [0, 0, 1, 2],
  );
});

test("what is said of a moment: nothing that was not measured", () => {
  const run = { color: 0, path: [], time: [0, 1], error: [1.234, null], unseen: [0.5, 0.25] };
  assert.equal(reading([run], 0), "0.00 s · error 1.2 cm · unseen 0.50");
  assert.equal(reading([run], 1), "1.00 s · unseen 0.25");
  assert.equal(reading([{ ...run, error: null, unseen: null }], 0), "0.00 s");
  assert.equal(reading([run, run], 0), "0.00 s");
});

/// Records of 8 floats with centres on the z axis.
function recordsAt(...depths) {
  return Float32Array.from(depths.flatMap((z) => [7, 7, z, 0, 0, 0, 0, 0]));
}

test("splats are drawn from the farthest to the nearest", () => {
  const order = new Uint32Array(4);
  orderByDepth(recordsAt(3, -1, 10, 5), [0, 0, 1], [0, 0, 1], order);
  assert.deepEqual([...order], [2, 3, 0, 1]);
  orderByDepth(recordsAt(3, -1, 10, 5), [0, 0, 1], [0, 0, -1], order);
  assert.deepEqual([...order], [1, 0, 3, 2]);
});

test("splats of one depth, and none at all, are ordered too", () => {
  const order = new Uint32Array(3);
  orderByDepth(recordsAt(2, 2, 2), [0, 0, 0], [0, 0, 1], order);
  assert.deepEqual([...order].sort(), [0, 1, 2]);
  orderByDepth(recordsAt(), [0, 0, 0], [0, 0, 1], new Uint32Array(0));
});

test("median of the records that have a value", () => {
  const records = recordsAt(5, 1, 9, -4);
  const depth = (at) => (records[at + 2] > 0 ? records[at + 2] : undefined);
  assert.equal(medianOf(records, 100, depth), 5);
  assert.equal(
    medianOf(records, 100, () => undefined),
    undefined,
  );
});

/// One disc as report/scene.cc packs it: 16-bit centre, colour, length of the longest axis, two axes.
function packed({ centre, color, length, axes }) {
  const bytes = new Uint8Array(16);
  new Uint16Array(bytes.buffer, 0, 3).set(centre);
  bytes.set(color, 6);
  bytes[9] = length;
  new Int8Array(bytes.buffer, 10).set(axes);
  const data = Buffer.from(bytes).toString("base64");
  return { count: 1, low: [1, 2, 3], step: 0.001, shortest_axis: 0.01, axis_steps: 30, data };
}

test("discs are unpacked, and face the cameras that saw them", () => {
  const discs = unpackDiscs(
    packed({
      centre: [0, 1000, 2000],
      color: [1, 2, 3],
      length: 30,
      axes: [127, 0, 0, 0, -127, 0],
    }),
  );
  assertNear(discs.xyz, [1, 3, 5], 1e-6);
  assertNear(discs.axes, [0.01 * Math.E, 0, 0, 0, -0.01 * Math.E, 0], 1e-6);
  assert.deepEqual([...discs.rgb.subarray(0, 3)], [1, 2, 3]);
  assertNear(seenSides(discs, [1, 3, 9, 1, 3, 6]), [0, 0, 1, 0, 0, 1], 1e-6);
  assertNear(seenSides(discs, [1, 3, 4, 1, 3, 9]), [0, 0, -1, 0, 0, -1], 1e-6);
});

test("a disc on the screen: round from the front, a pixel's line from the side, none behind", () => {
  const cam = orbitCamera(kSubject, kLevel, 640, 480);
  const size = 10 * cam.scale;
  const front = [...cam.right, ...cam.up].map((v) => v * size);
  const facing = screenDisc(cam, kSubject.centre, Float32Array.from(front), 1);
  assertNear([facing.x, facing.y, facing.dx, facing.dy], [320, 240, 10, 10], 1e-3);
  const edge = [...cam.right, ...cam.back].map((v) => v * size);
  const line = screenDisc(cam, kSubject.centre, Float32Array.from(edge), 1);
  assertNear([line.dx, line.dy], [10, 0.4], 1e-3);
  assert.equal(
    screenDisc(cam, mix([1, cam.eye], [1, cam.back]), Float32Array.from(front), 1),
    null,
  );
  const clipped = screenDisc(
    cam,
    kSubject.centre,
    Float32Array.from(front),
    Math.SQRT2 * size * 0.5,
  );
  assertNear([clipped.dx], [5], 1e-3);
});
