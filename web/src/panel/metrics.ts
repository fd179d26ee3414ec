// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
import type { Metrics } from "../data/protocol";
import { make, need } from "../dom";

/// Shows the run's most important scores, as the server prints them, or hides them (null).
export function showMetrics(metrics: Metrics | null): void {
  need("metrics").hidden = metrics === null;
  const cells = (metrics?.lines ?? [])
    .filter((line) => line.main)
    .map((line) => {
      const cell = make("div");
      cell.title = line.meaning;
      cell.append(make("dt", "", line.label), make("dd", "", line.value));
      return cell;
    });
  need("metric-list").replaceChildren(...cells);
}
