// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
import { kPanes, type Pane, type Picture } from "./data/protocol";
import { need } from "./dom";
import { preference, remember } from "./preferences";

/// The four images of the current frame. Folded away they are not even sent.
export class Panes {
  private readonly strip = need("panes");
  private readonly button = need<HTMLButtonElement>("panes-toggle");
  private readonly canvases: HTMLCanvasElement[];

  constructor(private readonly changed: () => void) {
    this.canvases = kPanes.map((pane) => need<HTMLCanvasElement>(`pane-${pane}`));
    this.setOpen(preference("panes", ["open", "closed"]) !== "closed");
    this.button.onclick = () => this.toggle();
  }

  get wanted(): Pane[] {
    return this.strip.hidden ? [] : [...kPanes];
  }

  toggle(): void {
    this.setOpen(this.strip.hidden);
    remember("panes", this.strip.hidden ? "closed" : "open");
    this.changed();
  }

  async receive(picture: Picture): Promise<void> {
    const canvas = this.canvases[picture.pane];
    if (!canvas) return;
    const bitmap = await createImageBitmap(new Blob([picture.jpeg], { type: "image/jpeg" }));
    if (canvas.width !== bitmap.width) canvas.width = bitmap.width;
    if (canvas.height !== bitmap.height) canvas.height = bitmap.height;
    canvas.getContext("2d")?.drawImage(bitmap, 0, 0);
    bitmap.close();
    canvas.parentElement?.classList.add("filled");
  }

  private setOpen(open: boolean): void {
    this.strip.hidden = !open;
    this.button.setAttribute("aria-expanded", String(open));
  }
}
