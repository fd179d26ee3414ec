// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import type { State, Status } from "../data/protocol";
import { kStatuses } from "../data/protocol";
import { need } from "../dom";
import { startTime_s } from "../time";
import { onThemeChange, theme } from "../theme";

const kHeight_px = 108;
const kMostSamples = 6000;
const kSync = uPlot.sync("time");

/// Samples of all charts, one column each, oldest first.
class Samples {
  time_s: number[] = [];
  condition: (number | null)[] = [];
  planarity: (number | null)[] = [];
  status: Status[] = [];

  clear(): void {
    for (const column of [this.time_s, this.condition, this.planarity, this.status])
      column.length = 0;
  }

  add(state: State): void {
    const last = this.time_s[this.time_s.length - 1];
    if (state.time === last) return;
    // A replay that starts again.
    if (last !== undefined && state.time < last) this.clear();
    this.time_s.push(state.time);
    this.condition.push(state.condition !== null && state.condition > 0 ? state.condition : null);
    this.planarity.push(state.planarity);
    this.status.push(state.status);
    if (this.time_s.length > kMostSamples) this.thin();
  }

  /// Halves the number of samples.
  private thin(): void {
    const even = (_: unknown, i: number) => i % 2 === 0;
    this.time_s = this.time_s.filter(even);
    this.condition = this.condition.filter(even);
    this.planarity = this.planarity.filter(even);
    this.status = this.status.filter(even);
  }
}

/// Condition number (logarithmic) and planarity (0..1) over time. The ground is shaded where the
/// tracker was degenerate, and darker where it was lost.
export class Charts {
  private samples = new Samples();
  private condition: uPlot;
  private planarity: uPlot;
  private pending = false;

  constructor() {
    [this.condition, this.planarity] = this.make();
    onThemeChange(() => {
      this.condition.destroy();
      this.planarity.destroy();
      [this.condition, this.planarity] = this.make();
      this.draw();
    });
    new ResizeObserver(() => this.resize()).observe(need("condition-chart"));
  }

  clear(): void {
    this.samples.clear();
    this.schedule();
  }

  add(state: State): void {
    this.samples.add(state);
    this.schedule();
  }

  /// A few times a second is as much as anyone reads off a chart.
  private schedule(): void {
    if (this.pending) return;
    this.pending = true;
    setTimeout(() => {
      this.pending = false;
      this.draw();
    }, 250);
  }

  private draw(): void {
    const { time_s, condition, planarity } = this.samples;
    const start = startTime_s(time_s[0]);
    const x = time_s.map((t) => t - start);
    this.condition.setData([x, condition]);
    this.planarity.setData([x, planarity]);
  }

  private resize(): void {
    const width = need("condition-chart").clientWidth;
    if (width > 0) {
      this.condition.setSize({ width, height: kHeight_px });
      this.planarity.setSize({ width, height: kHeight_px });
    }
  }

  private make(): [uPlot, uPlot] {
    const log: uPlot.Scale = { distr: 3, log: 10, range: (_, low, high) => decades(low, high) };
    const unit: uPlot.Scale = { range: [0, 1] };
    return [
      this.chart("condition-chart", theme().ink, log, decadeTicks),
      this.chart("planarity-chart", theme().planarity, unit, () => [0, 0.5, 1]),
    ];
  }

  private chart(
    id: string,
    color: string,
    scale: uPlot.Scale,
    splits: (u: uPlot, axis: number, low: number, high: number) => number[],
  ): uPlot {
    const { muted, line } = theme();
    const common = {
      stroke: muted,
      font: "10px ui-monospace, monospace",
      grid: { stroke: line, width: 1 },
      ticks: { show: false },
    };
    const options: uPlot.Options = {
      width: need(id).clientWidth || 320,
      height: kHeight_px,
      legend: { show: false },
      padding: [6, 10, 0, 0],
      cursor: { y: false, drag: { x: false, y: false }, sync: { key: kSync.key } },
      scales: { x: { time: false }, y: scale },
      axes: [
        {
          ...common,
          size: 24,
          gap: 6,
          space: 48,
          values: (_, ticks) => ticks.map((t) => `${t} s`),
        },
        { ...common, size: 40, gap: 3, splits, values: (_, ticks) => ticks.map(tickText) },
      ],
      series: [{}, { stroke: color, width: 1.5, points: { show: false } }],
      hooks: {
        drawClear: [(u) => this.shade(u)],
        setCursor: [(u) => this.showValue(u, id)],
      },
    };
    return new uPlot(options, [[], []], need<HTMLElement>(id));
  }

  /// Grounds for frames that were not ok; degenerate ones hatched as well.
  private shade(u: uPlot): void {
    const { status, time_s } = this.samples;
    const start = startTime_s(time_s[0]);
    const { top, height } = u.bbox;
    for (let i = 0; i < status.length; ) {
      let j = i;
      while (j + 1 < status.length && status[j + 1] === status[i]) ++j;
      const kind = status[i]!;
      if (kind !== kStatuses[0]) {
        const from = u.valToPos(time_s[i]! - start, "x", true);
        const to = u.valToPos(time_s[Math.min(j + 1, status.length - 1)]! - start, "x", true);
        u.ctx.save();
        u.ctx.fillStyle = theme()[kind];
        u.ctx.globalAlpha = kind === "lost" ? 0.4 : 0.16;
        u.ctx.fillRect(from, top, Math.max(1, to - from), height);
        u.ctx.restore();
      }
      i = j + 1;
    }
  }

  private showValue(u: uPlot, id: string): void {
    const index = u.cursor.idx;
    const value = index === null || index === undefined ? u.data[1]?.at(-1) : u.data[1]?.[index];
    const text =
      typeof value !== "number"
        ? "–"
        : id === "planarity-chart"
          ? value.toFixed(2)
          : tickText(value);
    need(`${id}-value`).textContent = text;
  }

  /// Latest values beside the titles, unless the cursor points at others.
  showLatest(state: State): void {
    if (this.condition.cursor.idx !== null && this.condition.cursor.idx !== undefined) return;
    need("condition-chart-value").textContent =
      state.condition === null ? "–" : tickText(state.condition);
    need("planarity-chart-value").textContent =
      state.planarity === null ? "–" : state.planarity.toFixed(2);
  }
}

function decades(low: number | null, high: number | null): [number, number] {
  const from = Math.floor(Math.log10(Math.max(1, low ?? 1)));
  const to = Math.ceil(Math.log10(Math.max(10, high ?? 100)));
  return [10 ** from, 10 ** Math.max(from + 1, to)];
}

function decadeTicks(_: uPlot, __: number, low: number, high: number): number[] {
  const [from, to] = [Math.round(Math.log10(low)), Math.round(Math.log10(high))];
  const step = Math.max(1, Math.ceil((to - from) / 4));
  const ticks = [];
  for (let power = from; power <= to; power += step) ticks.push(10 ** power);
  return ticks;
}

function tickText(value: number | null): string {
  if (value === null) return "";
  if (value === 0 || (value >= 0.1 && value < 1000)) return String(Number(value.toPrecision(3)));
  if (value >= 1000 && value < 1e5) return `${Number((value / 1000).toPrecision(3))}k`;
  return value.toExponential(0).replace("e+", "e");
}
