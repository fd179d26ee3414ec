// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
import type { Metrics } from "../data/protocol";
import { make, need } from "../dom";

type Row = [key: string, label: string, text: (value: number) => string];

const fixed =
  (digits: number, unit: string, factor = 1) =>
  (value: number) =>
    `${(value * factor).toFixed(digits)}${unit}`;
const count = (value: number) => Math.round(value).toLocaleString("en");

/// The keys of metrics.json worth showing, in the order of interest.
const kRows: Row[] = [
  ["ate_rmse_m", "ATE RMSE", fixed(1, " mm", 1000)],
  ["rpe_trans_1s_m", "drift in 1 s", fixed(1, " mm", 1000)],
  ["rpe_rot_1s_deg", "turn in 1 s", fixed(2, "°")],
  ["psnr_db", "PSNR", fixed(2, " dB")],
  ["ssim", "SSIM", fixed(3, "")],
  ["lpips", "LPIPS", fixed(3, "")],
  ["depth_l1_m", "depth error", fixed(1, " mm", 1000)],
  ["frames_tracked", "frames tracked", count],
  ["frames_lost", "frames lost", count],
  ["degenerate_percent", "degenerate", fixed(1, " %")],
  ["gaussians", "Gaussians", count],
  ["keyframes", "keyframes", count],
  ["fps_system", "system speed", fixed(1, " fps")],
  ["track_ms_p50", "tracking", fixed(1, " ms")],
  ["map_iteration_ms_p50", "map iteration", fixed(1, " ms")],
  ["peak_rss_bytes", "peak memory", fixed(0, " MB", 1e-6)],
];

/// Label and value of what `metrics` has.
export function metricRows(metrics: Metrics): [label: string, text: string][] {
  return kRows.flatMap(([key, label, text]) => {
    const value = metrics[key];
    return typeof value === "number" ? [[label, text(value)] as [string, string]] : [];
  });
}

/// Shows the run's scores, or hides them (null).
export function showMetrics(metrics: Metrics | null): void {
  need("metrics").hidden = metrics === null;
  const cells = metricRows(metrics ?? { type: "metrics" }).map(([label, text]) => {
    const cell = make("div");
    cell.append(make("dt", "", label), make("dd", "", text));
    return cell;
  });
  need("metric-list").replaceChildren(...cells);
}
