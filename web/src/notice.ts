// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
import { need } from "./dom";

/// The message over the stage: connection lost, retried in so many seconds; or what the server says.
export class Notice {
  private readonly box = need("notice");
  private timer = 0;

  hide(): void {
    window.clearInterval(this.timer);
    this.box.hidden = true;
  }

  show(text: string): void {
    window.clearInterval(this.timer);
    this.box.textContent = text;
    this.box.hidden = false;
  }

  countDown(text: string, seconds: number): void {
    const end_ms = performance.now() + 1000 * seconds;
    const tick = () => {
      const left_s = Math.max(0, Math.ceil((end_ms - performance.now()) / 1000));
      this.box.textContent =
        left_s > 0 ? `${text} Next attempt in ${left_s} s.` : `${text} Connecting…`;
    };
    this.show(text);
    tick();
    this.timer = window.setInterval(tick, 250);
  }
}
