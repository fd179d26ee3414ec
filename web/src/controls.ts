// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
import { need } from "./dom";

/// A row of buttons of which one is pressed: `<div id=... role=radiogroup>` with buttons that carry
/// data-value.
export class Choice<T extends string> {
  private readonly buttons: HTMLButtonElement[];

  constructor(id: string, chosen: (value: T) => void) {
    this.buttons = [...need(id).querySelectorAll<HTMLButtonElement>("button")];
    for (const button of this.buttons) {
      button.onclick = () => chosen(button.dataset["value"] as T);
    }
  }

  set(value: T): void {
    for (const button of this.buttons) {
      button.setAttribute("aria-checked", String(button.dataset["value"] === value));
    }
  }

  setAvailable(values: readonly T[]): void {
    for (const button of this.buttons) {
      button.disabled = !values.includes(button.dataset["value"] as T);
    }
  }
}

/// Saves a canvas as a PNG file.
export function saveImage(canvas: HTMLCanvasElement, name: string): void {
  canvas.toBlob((blob) => {
    if (!blob) return;
    const link = document.createElement("a");
    link.href = URL.createObjectURL(blob);
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
  }, "image/png");
}
