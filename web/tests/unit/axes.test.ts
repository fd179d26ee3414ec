// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import { axisReadings, kAxisNames, shownAxes } from "../../src/data/axes";
import { coefficients, dot, eigenSymmetric, orthonormalise } from "../../src/data/linalg";
import type { Six, State } from "../../src/data/protocol";
import { statusWords } from "../../src/data/words";

const kSeenSnr: Six<number | null> = [50, 60, 70, 80, 90, 100];

/// Rotations about x y z, then translations along them: index of a unit twist.
const kTurn = { x: 0, y: 1, z: 2 };
const kSlide = { x: 3, y: 4, z: 5 };

function twist(...parts: [index: number, value: number][]): Six {
  const out: Six = [0, 0, 0, 0, 0, 0];
  for (const [index, value] of parts) out[index] = value;
  return out;
}

/// A spectrum whose first `weak.length` axes are unseen.
function spectrum(weak: Six[], seen: Six[], weight = 1) {
  const weights = [...weak.map(() => weight), ...seen.map(() => 0)] as Six;
  return {
    axes: [...weak, ...seen] as Six<Six>,
    weights,
    snr: kSeenSnr,
    mask: (1 << weak.length) - 1,
  };
}

function words(
  s: ReturnType<typeof spectrum>,
  status: State["status"],
  source = "photometric",
): string {
  const state = {
    status,
    lost: status === "lost" ? "Too dark." : null,
    mask: s.mask,
    prior_active: status === "degenerate",
    prior_source: source,
  };
  return statusWords(state, shownAxes(s));
}

const units = [0, 1, 2, 3, 4, 5].map((i) => twist([i, 1]));
const others = (...taken: number[]) => units.filter((_, i) => !taken.includes(i));

test("eigenvectors of a symmetric matrix", () => {
  const { values, vectors } = eigenSymmetric([
    [2, 1, 0],
    [1, 2, 0],
    [0, 0, 5],
  ]);
  [1, 3, 5].forEach((value, i) => assert.ok(Math.abs(values[i]! - value) < 1e-12));
  assert.ok(Math.abs(vectors[0]![0]! + vectors[0]![1]!) < 1e-12);
});

test("orthonormalising leaves out what adds nothing", () => {
  const basis = orthonormalise([
    [1, 1, 0],
    [2, 2, 0],
    [1, 0, 0],
  ]);
  assert.equal(basis.length, 2);
  assert.ok(Math.abs(dot(basis[0]!, basis[1]!)) < 1e-12);
});

test("coefficients in a skew basis", () => {
  const h = Math.SQRT1_2;
  const [a, b] = coefficients(
    [3, 2],
    [
      [1, 0],
      [h, h],
    ],
  );
  assert.ok(Math.abs(a! - 1) < 1e-12 && Math.abs(b! - 2 / h) < 1e-12);
});

test("a corridor: one sliding", () => {
  const s = spectrum([twist([kSlide.z, -1])], others(kSlide.z));
  assert.equal(words(s, "degenerate"), "sliding along z is unobservable: vision fills it");
  const shown = shownAxes(s);
  assert.deepEqual(shown[2]!.direction.map(Math.round), [0, 0, 1]);
  assert.deepEqual(
    shown.map((axis) => axis.unseen),
    [false, false, true, false, false, false],
  );
});

test("a plane whose eigenvectors are mixed still reads x, y and z", () => {
  const [c, s] = [Math.cos(0.7), Math.sin(0.7)];
  const weak = [
    twist([kTurn.z, c], [kSlide.x, s]),
    twist([kTurn.z, -s * c], [kSlide.x, c * c], [kSlide.y, s]),
    twist([kTurn.z, s * s], [kSlide.x, -c * s], [kSlide.y, c]),
  ];
  const plane = spectrum(weak, others(kTurn.z, kSlide.x, kSlide.y));
  assert.equal(
    words(plane, "degenerate"),
    "sliding along x and y and turning about z are unobservable: vision fills them",
  );
  for (const [i, axis] of shownAxes(plane).entries()) {
    assert.equal(axis.kind === "slide" ? axis.letter : axis.letter + 3, i);
    assert.ok(axis.direction[axis.letter]! > 0.999, `${kAxisNames[i]} along ${axis.direction}`);
  }
});

test("a tilted plane gives six different names", () => {
  // Seen from 45 degrees: slidings along x and along (y - z), turning about the normal (y + z).
  const h = Math.SQRT1_2;
  const weak = [
    twist([kSlide.x, 1]),
    twist([kSlide.y, h], [kSlide.z, -h]),
    twist([kTurn.y, h], [kTurn.z, h]),
  ];
  const seen = [
    twist([kSlide.y, h], [kSlide.z, h]),
    twist([kTurn.y, h], [kTurn.z, -h]),
    twist([kTurn.x, 1]),
  ];
  const shown = shownAxes(spectrum(weak, seen));
  assert.equal(shown.filter((axis) => axis.unseen && axis.kind === "slide").length, 2);
  assert.equal(shown.filter((axis) => axis.unseen && axis.kind === "turn").length, 1);
  const named = new Set(shown.map((axis) => `${axis.kind} ${axis.letter}`));
  assert.equal(named.size, 6);
});

test("weights and ratios go with their axes", () => {
  const s = spectrum([twist([kTurn.y, 1])], others(kTurn.y), 0.8);
  const shown = shownAxes(s);
  const turn_y = shown[4]!;
  assert.ok(Math.abs(turn_y.weight - 0.8) < 1e-9);
  assert.ok(Math.abs(turn_y.snr! - 50) < 1e-6);
  assert.ok(shown.every((axis, i) => i === 4 || axis.weight < 1e-9));
});

test("infinite ratios stay infinite, missing ones missing", () => {
  const s = spectrum([], units);
  s.snr = [null, 2, 3, 4, 5, 6];
  assert.equal(shownAxes(s)[3]!.snr, Infinity);
  assert.equal(shownAxes({ ...s, snr: null })[0]!.snr, null);
});

test("axes of scaled twists need not be orthogonal", () => {
  // Rotations about a far centroid come with translations.
  const weak = [twist([kTurn.z, 0.6], [kSlide.x, 0.8]), twist([kSlide.x, 1])];
  const s = spectrum(weak, others(kTurn.z, kSlide.x));
  assert.equal(
    words(s, "degenerate"),
    "sliding along x and turning about z are unobservable: vision fills them",
  );
});

test("weights of axes about a far centroid stay apart", () => {
  // A plane 2 m ahead: what is seen are turnings about x and y around its centroid.
  const unit = (v: Six): Six => v.map((x) => x / Math.hypot(...v)) as Six;
  const weak = [units[kSlide.x]!, units[kSlide.y]!, units[kTurn.z]!];
  const seen = [
    unit(twist([kTurn.y, 1], [kSlide.x, -2])),
    unit(twist([kTurn.x, 1], [kSlide.y, 2])),
    units[kSlide.z]!,
  ];
  const plane = { ...spectrum(weak, seen), snr: [1, 1, 1, 5000, 5000, 5000] as Six };
  for (const axis of shownAxes(plane)) {
    assert.ok(Math.abs(axis.weight - (axis.unseen ? 1 : 0)) < 1e-9);
    assert.ok(Math.abs(axis.snr! / (axis.unseen ? 1 : 5000) - 1) < 1e-6);
  }
  assert.deepEqual(
    shownAxes(plane).map((axis) => axis.unseen),
    [true, true, false, false, false, true],
  );
});

test("words for the other states", () => {
  const plane = spectrum([units[kSlide.x]!, units[kSlide.y]!], others(kSlide.x, kSlide.y));
  assert.equal(words(spectrum([], units), "ok"), "all six axes are seen by geometry");
  assert.equal(words(spectrum([], units), "lost"), "lost. Too dark.");
  assert.equal(words(plane, "lost"), "lost: nothing sees sliding along x and y. Too dark.");
  assert.equal(
    words(plane, "degenerate", "cvm"),
    "sliding along x and y are unobservable: the motion model fills them",
  );
  assert.match(words(spectrum(units, []), "degenerate"), /^geometry sees no axis: vision/);
  const unfilled = {
    status: "ok" as const,
    lost: null,
    mask: 3,
    prior_active: false,
    prior_source: "none",
  };
  assert.equal(
    statusWords(unfilled, shownAxes(plane)),
    "sliding along x and y are unobservable: nothing fills them",
  );
  assert.equal(statusWords(unfilled, null), "two axes are unobservable: nothing fills them");
});

test("without directions the table shows axes by number", () => {
  const state = {
    weights: [1, 0.2, 0, 0, 0, 0],
    snr: [1, null, 3, 4, 5, 6],
    mask: 1,
  } as unknown as State;
  const rows = axisReadings(state, null);
  assert.deepEqual(rows[0], { name: "axis 0", weight: 1, snr: 1, unseen: true });
  assert.equal(rows[1]!.snr, Infinity);
});
