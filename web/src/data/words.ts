// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
import type { ShownAxis } from "./axes";
import type { State } from "./protocol";

const kLetters = ["x", "y", "z"];

function list(words: string[]): string {
  if (words.length < 2) return words.join("");
  return `${words.slice(0, -1).join(", ")} and ${words[words.length - 1]!}`;
}

/// "sliding along x and y and turning about z"
export function motionWords(axes: readonly ShownAxis[]): string {
  const letters = (kind: ShownAxis["kind"]) =>
    axes.filter((axis) => axis.kind === kind).map((axis) => kLetters[axis.letter]!);
  const slides = letters("slide");
  const turns = letters("turn");
  const parts = [];
  if (slides.length) parts.push(`sliding along ${list(slides)}`);
  if (turns.length) parts.push(`turning about ${list(turns)}`);
  return parts.join(" and ");
}

/// What fills the axes that geometry does not see.
export function filler(state: Pick<State, "status" | "prior_active" | "prior_source">): string {
  if (!state.prior_active || state.status === "lost") return "nothing";
  switch (state.prior_source) {
    case "cvm":
    case "zero":
      return "motion model";
    case "none":
      return "nothing";
    default:
      return "vision";
  }
}

function countWords(count: number): string {
  return (
    ["no axis", "one axis", "two axes", "three axes", "four axes", "five axes", "six axes"][
      count
    ] ?? ""
  );
}

/// The frame's observability in one sentence. `axes` null: directions are not known.
export function statusWords(
  state: Pick<State, "status" | "lost" | "mask" | "prior_active" | "prior_source">,
  axes: readonly ShownAxis[] | null,
): string {
  const bits = [0, 1, 2, 3, 4, 5].filter((k) => (state.mask >> k) & 1).length;
  const unseen = axes?.filter((axis) => axis.unseen) ?? null;
  if (state.status === "lost") {
    const why = state.lost ? ` ${state.lost}` : "";
    if (bits === 0 || !unseen) return `lost.${why}`;
    return `lost: nothing sees ${bits === 6 ? "any axis" : motionWords(unseen)}.${why}`;
  }
  if (bits === 0) return "all six axes are seen by geometry";
  const by = filler(state) === "motion model" ? "the motion model" : filler(state);
  if (bits === 6) return `geometry sees no axis: ${by} fills them all`;
  const subject = unseen ? motionWords(unseen) : countWords(bits);
  return bits === 1
    ? `${subject} is unobservable: ${by} fills it`
    : `${subject} are unobservable: ${by} fills them`;
}
