// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
import type { PerspectiveCamera } from "three";
import type { Picture, Request } from "../data/protocol";
import { poseOf } from "./pose";

/// Requests wait for the answer to the last one, but not longer than this.
const kPatience_ms = 1000;
const kShortestGap_ms = 60;
const kLargestSide_px = 1024;

/// The map as seen from the page's camera, rendered by the viewer. One request is under way at a
/// time; what changes meanwhile is asked for when it is answered.
export class PictureLayer {
  /// Sequence number of the picture on display, 0 = none.
  shown = 0;
  /// Camera of that picture: what is drawn over it has to use the same.
  shown_camera: PerspectiveCamera | null = null;
  private next = 1;
  private wanted = false;
  private asked = new Map<number, PerspectiveCamera>();
  private asked_at_ms = 0;
  private timer = 0;
  /// How often what was asked for was forgotten: a picture decoded meanwhile is not shown.
  private resets = 0;

  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly send: (request: Request) => boolean,
    private readonly changed: () => void,
  ) {}

  /// The camera or the map changed.
  request(camera: PerspectiveCamera): void {
    this.wanted = true;
    this.pump(camera);
  }

  /// Forgets what was asked for: the connection is new, or the mode was left.
  reset(): void {
    window.clearTimeout(this.timer);
    this.timer = 0;
    this.resets++;
    this.wanted = false;
    this.asked.clear();
    this.shown = 0;
    this.shown_camera = null;
  }

  async receive(picture: Picture, camera: PerspectiveCamera): Promise<void> {
    const asked = this.asked.get(picture.sequence);
    if (!asked) return;
    for (const seq of this.asked.keys()) if (seq <= picture.sequence) this.asked.delete(seq);
    const resets = this.resets;
    const bitmap = await createImageBitmap(new Blob([picture.jpeg], { type: "image/jpeg" }));
    if (this.resets !== resets) {
      bitmap.close();
      return;
    }
    if (this.canvas.width !== bitmap.width) this.canvas.width = bitmap.width;
    if (this.canvas.height !== bitmap.height) this.canvas.height = bitmap.height;
    this.canvas.getContext("2d")?.drawImage(bitmap, 0, 0);
    bitmap.close();
    this.shown = picture.sequence;
    this.shown_camera = asked;
    this.changed();
    if (this.wanted) this.pump(camera);
  }

  private pump(camera: PerspectiveCamera): void {
    const now = performance.now();
    const waits_ms = this.asked.size > 0 ? kPatience_ms : kShortestGap_ms;
    const left_ms = this.asked_at_ms + waits_ms - now;
    if (left_ms > 0) {
      window.clearTimeout(this.timer);
      this.timer = window.setTimeout(() => this.wanted && this.pump(camera), left_ms);
      return;
    }
    const scale = this.pixelScale();
    const seq = this.next++;
    const sent = this.send({
      type: "view",
      seq,
      pose: poseOf(camera),
      fov_y: (camera.fov * Math.PI) / 180,
      width: Math.max(16, Math.round(this.canvas.clientWidth * scale)),
      height: Math.max(16, Math.round(this.canvas.clientHeight * scale)),
    });
    if (!sent) return;
    this.wanted = false;
    this.asked_at_ms = now;
    this.asked.set(seq, camera.clone());
  }

  private pixelScale(): number {
    const largest = Math.max(this.canvas.clientWidth, this.canvas.clientHeight, 1);
    return Math.min(devicePixelRatio, kLargestSide_px / largest);
  }
}
