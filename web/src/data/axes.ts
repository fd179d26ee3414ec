// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
import { coefficients, combine, dot, eigenSymmetric, orthonormalise, type Vector } from "./linalg";
import type { Six, State } from "./protocol";

/// Names of the six camera axes in the order rows and arrows are shown.
export const kAxisNames = ["slide x", "slide y", "slide z", "turn x", "turn y", "turn z"] as const;

/// One of six motions as shown: which camera axis it is closest to, and how well geometry sees it.
export interface ShownAxis {
  kind: "slide" | "turn";
  /// 0 x, 1 y, 2 z
  letter: number;
  /// Unit direction of the translation or of the rotation's axis in the camera frame; the dominant
  /// component is positive.
  direction: [number, number, number];
  /// 0 = seen by geometry .. 1 = unseen.
  weight: number;
  /// Signal over noise; Infinity where there is no noise, null where not computed.
  snr: number | null;
  unseen: boolean;
}

/// One line of the table of axes.
export interface AxisReading {
  name: string;
  weight: number;
  snr: number | null;
  unseen: boolean;
}

type Spectrum = Pick<State, "weights" | "snr" | "mask"> & { axes: Six<Six> };

/// The table's lines: by camera axis where directions are known, else as they are numbered.
export function axisReadings(state: State, axes: readonly ShownAxis[] | null): AxisReading[] {
  if (axes) return axes.map((axis, i) => ({ ...axis, name: kAxisNames[i]! }));
  return state.weights.map((weight, k) => ({
    name: `axis ${k}`,
    weight,
    snr: state.snr ? (state.snr[k] ?? Infinity) : null,
    unseen: ((state.mask >> k) & 1) !== 0,
  }));
}

/// Inside a group of axes that are all seen, or all unseen, eigenvectors turn freely: on a plane any
/// mixture of the two slidings and the turning may come out. What the groups span is what counts, so
/// within each we take the basis that separates slidings from turnings and lies closest to x, y, z.
/// Returns six entries in the order of kAxisNames.
export function shownAxes(spectrum: Spectrum): ShownAxis[] {
  const unseen = members(spectrum, true);
  const unseen_basis = orthonormalise(unseen.map((m) => m.axis));
  // Camera twists of scaled axes are not orthogonal to one another. What geometry sees is shown as
  // what is left when the unseen is taken out; unit vectors fill up where that leaves gaps.
  const seen = members(spectrum, false).flatMap((m) => {
    const [rest] = orthonormalise([m.axis], unseen_basis);
    return rest ? [{ ...m, axis: rest }] : [];
  });
  const units = kAxisNames.map((_, i) => kAxisNames.map((_, j) => (i === j ? 1 : 0)));
  const all_seen = orthonormalise([...seen.map((m) => m.axis), ...units], unseen_basis);
  const seen_basis = all_seen.slice(0, 6 - unseen_basis.length);
  const candidates = [
    ...separate(unseen_basis).map((twist) => ({ twist, unseen: true, ...measures(twist, unseen) })),
    ...separate(seen_basis).map((twist) => ({ twist, unseen: false, ...measures(twist, seen) })),
  ];
  return assign(candidates.map((c) => c.twist)).map((slot, position) => {
    const { twist, ...measured } = candidates[slot]!;
    const kind = position < 3 ? "slide" : "turn";
    const letter = position % 3;
    const part = kind === "slide" ? twist.slice(3) : twist.slice(0, 3);
    const norm = Math.sqrt(dot(part, part)) * (part[letter]! < 0 ? -1 : 1);
    const unit = part.map((x) => x / (norm || 1)) as [number, number, number];
    return { kind, letter, direction: unit, ...measured };
  });
}

/// An axis of the spectrum with what was measured on it. snr: null = not measured.
interface Member {
  axis: Vector;
  weight: number;
  snr: number | null;
}

function members(spectrum: Spectrum, unseen: boolean): Member[] {
  return spectrum.axes.flatMap((axis, k) => {
    if (((spectrum.mask >> k) & 1) !== (unseen ? 1 : 0)) return [];
    const snr = spectrum.snr ? (spectrum.snr[k] ?? Infinity) : null;
    return [{ axis, weight: spectrum.weights[k]!, snr }];
  });
}

/// Weight and signal-to-noise of a twist: means over the axes of its group that it is made of.
function measures(twist: Vector, group: readonly Member[]): { weight: number; snr: number | null } {
  const shares = coefficients(
    twist,
    group.map((m) => m.axis),
  ).map((c) => c * c);
  const total = shares.reduce((a, b) => a + b, 0) || 1;
  const weight =
    dot(
      shares,
      group.map((m) => m.weight),
    ) / total;
  if (group.some((m) => m.snr === null)) return { weight, snr: null };
  // Means of logarithms: ratios lie decades apart. A share below a thousandth says nothing.
  const logs = group.map((m, k) =>
    shares[k]! < 1e-3 * total ? 0 : (shares[k]! / total) * Math.log(Math.max(1e-6, m.snr!)),
  );
  return { weight, snr: Math.exp(logs.reduce((a, b) => a + b, 0)) };
}

/// Turns an orthonormal basis of twists so that slidings and turnings separate, each as close to the
/// camera's axes as the span allows.
function separate(basis: Vector[]): Vector[] {
  if (basis.length === 0) return [];
  const rotations = basis.map((twist) => twist.slice(0, 3));
  const { values, vectors } = eigenSymmetric(rotations.map((a) => rotations.map((b) => dot(a, b))));
  const turned = vectors.map((coefficients) => combine(basis, coefficients));
  const slides = turned.filter((_, i) => values[i]! < 0.5);
  const turns = turned.filter((_, i) => values[i]! >= 0.5);
  return [...alignWithAxes(slides, 3), ...alignWithAxes(turns, 0)];
}

/// Within a span, takes repeatedly the direction nearest to a camera axis (of those with components
/// [offset, offset + 3)).
function alignWithAxes(span: Vector[], offset: number): Vector[] {
  const out: Vector[] = [];
  let rest = span;
  while (rest.length > 0) {
    const reach = [0, 1, 2].map((i) => rest.reduce((sum, v) => sum + v[offset + i]! ** 2, 0));
    const letter = reach.indexOf(Math.max(...reach));
    const projection = combine(
      rest,
      rest.map((v) => v[offset + letter]!),
    );
    const [chosen] = orthonormalise([projection]);
    if (!chosen) return [...out, ...rest];
    out.push(chosen);
    rest = orthonormalise(rest, [chosen]).slice(0, rest.length - 1);
  }
  return out;
}

/// Pairs the six places of kAxisNames with the six twists, the most certain pair first. Result: index
/// of the twist at each place.
function assign(twists: Vector[]): number[] {
  const pairs = twists.flatMap((twist, slot) =>
    kAxisNames.map((_, place) => ({
      slot,
      place,
      // Places are slidings first, twists rotations first.
      score: Math.abs(twist[(place + 3) % 6]!),
    })),
  );
  pairs.sort((a, b) => b.score - a.score);
  const places = new Array<number>(6).fill(-1);
  const used = new Set<number>();
  for (const { slot, place } of pairs) {
    if (places[place] !== -1 || used.has(slot)) continue;
    places[place] = slot;
    used.add(slot);
  }
  return places;
}
