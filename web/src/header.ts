// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
import type { Hello, State, Status } from "./data/protocol";
import { startTime_s } from "./time";
import { need, setText } from "./dom";

const kSigns: Record<Status, string> = { ok: "●", degenerate: "◐", lost: "✕" };
const kWords: Record<Status, string> = { ok: "tracking", degenerate: "degenerate", lost: "lost" };

/// The line at the top: what runs, how far it is, how it fares.
export class Header {
  private frames_total: number | null = null;
  private start_s: number | null = null;

  start(hello: Hello): void {
    this.frames_total = hello.frames_total;
    this.start_s = null;
    setText(need("input-name"), hello.input);
    need("input-name").title = hello.input;
    setText(need("run-kind"), [hello.tracker, hello.preset].filter(Boolean).join(" · "));
    need("version").textContent = hello.version;
    document.title = `${hello.input} · sgs`;
  }

  setState(state: State): void {
    this.start_s ??= startTime_s(state.time);
    const total = this.frames_total === null ? "" : ` / ${this.frames_total}`;
    setText(need("frame"), `${state.frame + 1}${total}`);
    setText(need("time"), `${(state.time - this.start_s).toFixed(1)} s`);
    setText(need("count"), state.gaussians.toLocaleString("en"));
    setText(need("fps"), state.fps === null ? "–" : state.fps.toFixed(0));
    setText(need("track-ms"), state.ms.track === null ? "–" : `${state.ms.track.toFixed(1)} ms`);
    const chip = need("status-chip");
    chip.dataset["status"] = state.status;
    setText(chip, `${kSigns[state.status]} ${state.finished ? "finished" : kWords[state.status]}`);
    const progress = need<HTMLProgressElement>("progress");
    progress.hidden = this.frames_total === null;
    if (this.frames_total !== null) progress.value = (state.frame + 1) / this.frames_total;
  }
}
