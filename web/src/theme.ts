// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0

/// Colours for what is drawn on canvases, read from the style sheet so that both themes are written
/// down once.
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

const kVariables: Record<keyof Theme, string> = {
  ink: "--ink",
  muted: "--muted",
  line: "--line",
  stage: "--stage",
  ok: "--ok",
  degenerate: "--degenerate",
  lost: "--lost",
  truth: "--truth",
  planarity: "--planarity",
};

function read(): Theme {
  const style = getComputedStyle(document.documentElement);
  const entries = Object.entries(kVariables).map(([key, name]) => [
    key,
    style.getPropertyValue(name).trim(),
  ]);
  return Object.fromEntries(entries) as Theme;
}

let current: Theme | null = null;
const listeners: (() => void)[] = [];

export function theme(): Theme {
  return (current ??= read());
}

export function onThemeChange(listener: () => void): void {
  listeners.push(listener);
}

matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
  current = null;
  for (const listener of listeners) listener();
});
