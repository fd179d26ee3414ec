// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
import { axisReadings, shownAxes } from "../data/axes";
import type { FrameColumn, Metrics, State } from "../data/protocol";
import { filler, statusWords } from "../data/words";
import { need, setText } from "../dom";
import { AxisRows } from "./axis_rows";
import { CameraIcon } from "./camera_icon";
import { Charts } from "./charts";
import { showMetrics } from "./metrics";
import { Values } from "./values";

/// The degeneracy panel: which of the six axes geometry sees, now and over time.
export class Panel {
  status_text = "";
  private readonly icon = new CameraIcon();
  private readonly rows = new AxisRows();
  private readonly charts = new Charts();
  private readonly values = new Values();
  private readonly sentence = need("status-sentence");

  clear(): void {
    this.status_text = "";
    setText(this.sentence, "waiting for the first frame");
    this.sentence.dataset["status"] = "none";
    this.charts.clear();
    this.values.update(null);
    showMetrics(null);
  }

  start(columns: readonly FrameColumn[]): void {
    this.values.start(columns);
  }

  setState(state: State): void {
    const axes = state.axes ? shownAxes({ ...state, axes: state.axes }) : null;
    this.icon.update(axes);
    this.rows.update(axisReadings(state, axes), filler(state));
    this.charts.add(state);
    this.values.update(state);
    this.charts.showLatest(state);
    this.status_text = statusWords(state, axes);
    setText(this.sentence, this.status_text);
    this.sentence.dataset["status"] = state.status;
  }

  /// Null = the run is not finished.
  setMetrics(metrics: Metrics | null): void {
    showMetrics(metrics);
  }
}
