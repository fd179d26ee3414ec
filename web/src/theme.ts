// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
import { need } from "./dom";

/// Colours for what is drawn on canvases, read from the style sheet so that they are written down
/// once.
export interface Theme {
  ink: string;
  muted: string;
  line: string;
  stage: string;
  ok: string;
  degenerate: string;
  lost: string;
  truth: string;
  planarity: string;
}

const kNames: (keyof Theme)[] = [
  "ink",
  "muted",
  "line",
  "stage",
  "ok",
  "degenerate",
  "lost",
  "truth",
  "planarity",
];

/// Colours as they are for `element`.
function read(element: Element): Theme {
  const style = getComputedStyle(element);
  const entries = kNames.map((name) => [name, style.getPropertyValue(`--${name}`).trim()]);
  return Object.fromEntries(entries) as Theme;
}

let page: Theme | null = null;
let stage: Theme | null = null;
const listeners: (() => void)[] = [];

/// Colours of the page around the stage.
export function theme(): Theme {
  return (page ??= read(document.documentElement));
}

/// Colours over the map.
export function stageTheme(): Theme {
  return (stage ??= read(need("stage")));
}

export function onThemeChange(listener: () => void): void {
  listeners.push(listener);
}

matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
  page = null;
  stage = null;
  for (const listener of listeners) listener();
});
