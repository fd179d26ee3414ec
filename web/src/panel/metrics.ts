// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
import type { Metrics } from "../data/protocol";
import { make, need } from "../dom";

type Row = [key: string, label: string, text: (value: number) => string];

const fixed = (digits: number, unit: string, factor = 1) => (value: number) =>
  `${(value * factor).toFixed(digits)}${unit}`;
const count = (value: number) => Math.round(value).toLocaleString("en");

/// The keys of metrics.json worth a line, in the order of interest.
const kRows: Row[] = [
  ["ate_rmse_m", "ATE RMSE", fixed(1, " mm", 1000)],
  ["ate_max_m", "ATE, largest", fixed(1, " mm", 1000)],
  ["rpe_trans_1s_m", "drift in 1 s", fixed(1, " mm", 1000)],
  ["rpe_rot_1s_deg", "turn drift in 1 s", fixed(2, "°")],
  ["psnr_db", "PSNR", fixed(2, " dB")],
  ["ssim", "SSIM", fixed(3, "")],
  ["lpips", "LPIPS", fixed(3, "")],
  ["depth_l1_m", "depth error", fixed(1, " mm", 1000)],
  ["frames_tracked", "frames tracked", count],
  ["frames_lost", "frames lost", count],
  ["degenerate_percent", "frames degenerate", fixed(1, " %")],
  ["gaussians", "Gaussians", count],
  ["keyframes", "keyframes", count],
  ["fps_system", "system speed", fixed(1, " frames/s")],
  ["track_ms_p50", "tracking, median", fixed(1, " ms")],
  ["map_iteration_ms_p50", "map iteration, median", fixed(1, " ms")],
  ["peak_rss_bytes", "peak memory", fixed(0, " MB", 1e-6)],
];

/// Rows of label and value for what `metrics` has.
export function metricRows(metrics: Metrics): [label: string, text: string][] {
  return kRows.flatMap(([key, label, text]) => {
    const value = metrics[key];
    return typeof value === "number" ? [[label, text(value)] as [string, string]] : [];
  });
}

export function showMetrics(metrics: Metrics | null): void {
  const section = need("metrics");
  section.hidden = metrics === null;
  const body = need("metric-rows");
  body.replaceChildren();
  for (const [label, text] of metrics ? metricRows(metrics) : []) {
    const row = make("tr");
    const name = make("th", "", label);
    name.scope = "row";
    row.append(name, make("td", "number", text));
    body.append(row);
  }
}
