// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import { kLongestRetry_s, retryDelay } from "../../src/data/connection";
import { GaussianStore } from "../../src/data/gaussians";
import { Path } from "../../src/data/path";
import {
  decodeBinary,
  parseText,
  type MapDiff,
  type Pose,
  type State,
} from "../../src/data/protocol";

interface Sketch {
  flags?: number;
  version?: number;
  put?: [id: number, x: number][];
  removed?: number[];
  degree?: number;
  /// First byte of the harmonics of each Gaussian put.
  harmonics?: number[];
}

function encode({
  flags = 2,
  version = 1,
  put = [],
  removed = [],
  degree = 0,
  harmonics = [],
}: Sketch): ArrayBuffer {
  const records_end = 24 + 48 * put.length + 4 * removed.length;
  const view = new DataView(new ArrayBuffer(records_end + 16 * degree * put.length));
  view.setUint8(2, degree);
  harmonics.forEach((value, i) => view.setUint8(records_end + 16 * degree * i, value));
  view.setUint8(0, 1);
  view.setUint8(1, flags);
  view.setBigUint64(8, BigInt(version), true);
  view.setUint32(16, put.length, true);
  view.setUint32(20, removed.length, true);
  put.forEach(([id, x], i) => {
    view.setUint32(24 + 48 * i, id, true);
    view.setFloat32(28 + 48 * i, x, true);
    view.setUint32(24 + 48 * i + 44, 0xff0000ff, true);
  });
  removed.forEach((id, i) => view.setUint32(24 + 48 * put.length + 4 * i, id, true));
  return view.buffer;
}

function decode(sketch: Sketch): MapDiff {
  const diff = decodeBinary(encode(sketch));
  assert.equal(diff?.kind, "map");
  return diff as MapDiff;
}

/// Position of the Gaussians that a store holds, by id.
function contents(store: GaussianStore): Map<number, number> {
  const entries = Array.from({ length: store.count }, (_, i): [number, number] => [
    store.words[12 * i]!,
    store.floats[12 * i + 1]!,
  ]);
  return new Map(entries);
}

test("map diffs are decoded", () => {
  const diff = decode({ flags: 3, version: 2 ** 33, put: [[7, 1.5]], removed: [3, 4] });
  assert.ok(diff.reset && diff.last);
  assert.equal(diff.version, 2 ** 33);
  assert.equal(diff.words[0], 7);
  assert.equal(diff.floats[1], 1.5);
  assert.deepEqual([...diff.removed], [3, 4]);
});

test("pictures are decoded", () => {
  const bytes = Uint8Array.of(2, 4, 0, 0, 0x2a, 0, 0, 0, 0xff, 0xd8);
  const picture = decodeBinary(bytes.buffer);
  assert.ok(picture?.kind === "picture");
  assert.equal(picture.pane, 4);
  assert.equal(picture.sequence, 42);
  assert.deepEqual([...picture.jpeg], [0xff, 0xd8]);
});

test("malformed messages are refused", () => {
  assert.equal(decodeBinary(new ArrayBuffer(3)), null);
  assert.equal(decodeBinary(Uint8Array.of(9, 0, 0, 0, 0, 0, 0, 0).buffer), null);
  const good = encode({ put: [[1, 0]] });
  assert.equal(decodeBinary(good.slice(0, good.byteLength - 4)), null);
  const lying = good.slice(0);
  new DataView(lying).setUint32(16, 0xffffffff, true);
  assert.equal(decodeBinary(lying), null);
  assert.equal(parseText("{"), null);
  assert.equal(parseText("null"), null);
  assert.equal(parseText('{"type":"surprise"}'), null);
  assert.equal(parseText('{"type":"error","message":"x"}')?.type, "error");
});

test("the store follows diffs", () => {
  const store = new GaussianStore();
  store.apply(
    decode({
      put: [
        [1, 1],
        [2, 2],
        [3, 3],
      ],
    }),
  );
  assert.deepEqual(store.takeDirty(), [0, 3]);
  store.apply(
    decode({
      version: 2,
      put: [
        [2, 20],
        [9, 9],
      ],
      removed: [1, 77],
    }),
  );
  assert.deepEqual(
    contents(store),
    new Map([
      [9, 9],
      [2, 20],
      [3, 3],
    ]),
  );
  assert.equal(store.version, 2);
  assert.deepEqual(store.takeDirty(), [0, 3]);
  assert.ok(store.takeDirty()[0] >= store.takeDirty()[1]);
});

test("harmonics follow their Gaussians", () => {
  const put: [number, number][] = [
    [1, 1],
    [2, 2],
    [3, 3],
  ];
  const store = new GaussianStore();
  store.apply(decode({ flags: 3, put, degree: 2, harmonics: [10, 20, 30] }));
  const first = (slot: number): number => store.harmonics[32 * slot]!;
  assert.equal(store.degree, 2);
  assert.deepEqual([first(0), first(1), first(2)], [10, 20, 30]);
  store.apply(decode({ version: 2, put: [[2, 2]], removed: [1], degree: 2, harmonics: [21] }));
  assert.deepEqual([first(0), first(1)], [30, 21]);
  const many = Array.from({ length: 5000 }, (_, i): [number, number] => [i + 10, i]);
  store.apply(decode({ version: 3, put: many, degree: 2, harmonics: many.map(() => 7) }));
  assert.deepEqual([first(0), first(1), first(5001)], [30, 21, 7]);
  store.apply(decode({ flags: 3, version: 4, put: [[1, 1]] }));
  assert.equal(store.degree, 0);
  assert.equal(store.harmonics.length, 0);
});

test("harmonics of no known degree are refused", () => {
  assert.equal(decodeBinary(encode({ put: [[1, 0]], degree: 4 })), null);
  assert.equal(decodeBinary(encode({ put: [[1, 0]], degree: 1 }).slice(0, -1)), null);
});

test("a version counts as held only with its last message", () => {
  const store = new GaussianStore();
  store.apply(decode({ flags: 1, version: 5, put: [[1, 1]] }));
  assert.equal(store.version, 0);
  store.apply(decode({ flags: 2, version: 5, put: [[2, 1]] }));
  assert.equal(store.version, 5);
  assert.equal(store.count, 2);
});

test("a reset forgets, and the store grows", () => {
  const store = new GaussianStore();
  const many = Array.from({ length: 10_000 }, (_, i): [number, number] => [i, i]);
  store.apply(decode({ put: many }));
  assert.equal(store.count, 10_000);
  assert.ok(store.capacity >= 10_000);
  assert.equal(contents(store).get(9_999), 9_999);
  store.apply(decode({ flags: 3, put: [[5, -5]] }));
  assert.deepEqual(contents(store), new Map([[5, -5]]));
});

test("random diffs leave what a plain map would hold", () => {
  const store = new GaussianStore();
  const truth = new Map<number, number>();
  let seed = 1;
  const random = (n: number) => (seed = (seed * 48271) % 2147483647) % n;
  for (let round = 0; round < 200; ++round) {
    const put = Array.from({ length: random(20) }, (): [number, number] => [
      random(60),
      random(1000),
    ]);
    const removed = Array.from({ length: random(20) }, () => random(60));
    store.apply(decode({ put, removed }));
    for (const [id, x] of put) truth.set(id, x);
    for (const id of removed) truth.delete(id);
    assert.deepEqual(contents(store), truth);
  }
});

test("a chunk replaces the path from its first frame on", () => {
  const pose = (x: number): Pose => [x, 0, 0, 0, 0, 0, 1];
  const path = new Path();
  const chunk = (first: number, status: number[]) =>
    path.addChunk({
      type: "path",
      first,
      estimate: status.map((_, i) => pose(first + i)),
      truth: status.map(() => null),
      status,
    });
  chunk(0, [0, 0, 0, 0]);
  chunk(2, [1, 3]); // 3: no such frame
  assert.deepEqual(
    path.points.map((p) => p?.status),
    ["ok", "ok", "degenerate"],
  );
  path.addState({ frame: 5, pose: pose(5), truth: null, status: "lost" } as State);
  assert.equal(path.points[4], undefined);
  assert.equal(path.points[5]?.status, "lost");
  path.addState({ frame: 0, pose: pose(0), truth: null, status: "ok" } as State);
  assert.equal(path.points.length, 1, "a replay starts again");
});

test("attempts to reconnect thin out", () => {
  assert.equal(retryDelay(0), 0.5);
  assert.equal(retryDelay(2), 2);
  assert.equal(retryDelay(50), kLongestRetry_s);
});

test("a state's own fields come from its values", () => {
  const text = JSON.stringify({
    type: "state",
    frame: 3,
    map_ms: 4,
    values: { weight: [0, 0, 1, 0, 0, 0], degenerate_mask: 4, track_ms: 5, later: 1 },
  });
  const state = parseText(text) as State;
  assert.equal(state.mask, 4);
  assert.equal(state.weights[2], 1);
  assert.deepEqual(state.ms, { track: 5, map: 4 });
  assert.equal(state.values["later"], 1);
  assert.equal(parseText(`{"type":"state","frame":3}`), null);
});
