// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
import { make, need } from "./dom";

export interface Shortcut {
  key: string;
  /// As shown in the overlay, where the key itself would not do.
  shown?: string;
  what: string;
  run(): void;
}

/// Binds the shortcuts and lists them in the help overlay ("?" opens it, Escape closes it).
export function bindKeys(shortcuts: Shortcut[]): void {
  const dialog = need<HTMLDialogElement>("help");
  const toggle = () => (dialog.open ? dialog.close() : dialog.showModal());
  const all = [...shortcuts, { key: "?", what: "this help", run: toggle }];
  const list = need("shortcuts");
  for (const { key, shown, what } of all) {
    const row = make("tr");
    const cell = make("td");
    cell.append(make("kbd", "", shown ?? key));
    row.append(cell, make("td", "", what));
    list.append(row);
  }
  need("help-button").onclick = toggle;
  need("help-close").onclick = () => dialog.close();
  dialog.onclick = (event) => {
    if (event.target === dialog) dialog.close();
  };
  addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (dialog.open && event.key !== "?") return;
    const shortcut = all.find(({ key }) => key === event.key);
    if (!shortcut) return;
    event.preventDefault();
    shortcut.run();
  });
}
