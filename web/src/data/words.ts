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
function filler(source: string): string {
  switch (source) {
    case "cvm":
    case "zero":
      return "the motion model";
    case "none":
      return "nothing";
    default:
      return "vision";
  }
}

/// The frame's observability in one sentence.
export function statusWords(
  state: Pick<State, "status" | "prior_active" | "prior_source">,
  axes: readonly ShownAxis[],
): string {
  const unseen = axes.filter((axis) => axis.unseen);
  if (state.status === "lost") {
    if (unseen.length === 0) return "lost: the pose is held";
    return `lost: nothing sees ${motionWords(unseen)}; the pose is held`;
  }
  if (unseen.length === 0) return "all six axes are seen by geometry";
  if (unseen.length === 6) {
    return `geometry sees no axis: ${filler(state.prior_active ? state.prior_source : "none")} fills them`;
  }
  const by = filler(state.prior_active ? state.prior_source : "none");
  const one = unseen.length === 1;
  return `${motionWords(unseen)} ${one ? "is" : "are"} unobservable: ${by} fills ${one ? "it" : "them"}`;
}
