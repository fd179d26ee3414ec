// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
import type { FrameColumn, State } from "../data/protocol";
import { make, need } from "../dom";

/// A value as text: words as they are, numbers short, lists entry by entry.
export function valueText(value: unknown): string {
  if (value === null || value === undefined) return "–";
  if (Array.isArray(value)) return value.map(valueText).join(" ");
  if (typeof value === "number") return String(Number(value.toPrecision(4)));
  if (typeof value === "boolean") return value ? "yes" : "no";
  return typeof value === "string" ? value : JSON.stringify(value);
}

/// The list of every per-frame value that the server announces. Filled only while it is open.
export class Values {
  private readonly list = need("value-list");
  private readonly details = need<HTMLDetailsElement>("values");
  private cells: [key: string, cell: HTMLElement][] = [];
  private state: State | null = null;

  constructor() {
    this.details.addEventListener("toggle", () => this.show());
  }

  start(columns: readonly FrameColumn[]): void {
    // The axes are 36 numbers that the figure shows better.
    const shown = columns.filter((column) => column.key !== "axis");
    this.cells = shown.map(({ key }) => [key, make("dd", "", "–")]);
    const rows = shown.map(({ key, unit, meaning }, i) => {
      const row = make("div");
      row.title = meaning;
      row.append(make("dt", "", unit ? `${key} [${unit}]` : key), this.cells[i]![1]);
      return row;
    });
    this.list.replaceChildren(...rows);
  }

  update(state: State | null): void {
    this.state = state;
    this.show();
  }

  private show(): void {
    if (!this.details.open) return;
    for (const [key, cell] of this.cells) cell.textContent = valueText(this.state?.values[key]);
  }
}
