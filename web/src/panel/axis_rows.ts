// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
import { kAxisNames, type AxisReading } from "../data/axes";
import { make, need, setText } from "../dom";

/// "3.1", "420", "12k": three characters or so.
export function ratioText(value: number | null): string {
  if (value === null) return "–";
  if (!Number.isFinite(value)) return "∞";
  if (value < 10) return value.toFixed(1);
  if (value < 1000) return value.toFixed(0);
  if (value < 1e6) return `${(value / 1000).toFixed(value < 1e4 ? 1 : 0)}k`;
  return value.toExponential(0).replace("e+", "e");
}

/// Six rows: name, weight bar, weight, signal over noise.
export class AxisRows {
  private readonly rows = kAxisNames.map((name) => {
    const row = make("tr");
    const label = make("th", "", name);
    label.scope = "row";
    const bar = make("div", "weight-bar");
    bar.append(make("i"));
    const bar_cell = make("td", "bar-cell");
    bar_cell.append(bar);
    const weight = make("td", "number");
    const snr = make("td", "number");
    const verdict = make("td", "verdict");
    row.append(label, bar_cell, weight, snr, verdict);
    return { row, label, bar, weight, snr, verdict };
  });

  constructor() {
    need("axis-rows").append(...this.rows.map(({ row }) => row));
  }

  /// `filler`: who decides on the unseen ones.
  update(axes: readonly AxisReading[], filler: string): void {
    axes.forEach((axis, i) => {
      const { row, label, bar, weight, snr, verdict } = this.rows[i]!;
      setText(label, axis.name);
      row.className = axis.unseen ? "unseen" : "seen";
      bar.style.setProperty("--weight", axis.weight.toFixed(3));
      setText(weight, axis.weight.toFixed(2));
      setText(snr, ratioText(axis.snr));
      setText(verdict, axis.unseen ? `○ ${filler}` : "● geometry");
    });
  }
}
