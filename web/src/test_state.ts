// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
import type { CameraMode } from "./stage/camera_rig";
import type { DisplayMode } from "./stage/stage";
import type { Session } from "./data/protocol";
import type { WebGlKind } from "./stage/webgl";

/// What tests (and the curious, in the browser's console) may look at.
export interface PageState {
  connected: boolean;
  /// -1 before the first.
  frame: number;
  /// In the session's map, as it says.
  gaussians: number;
  /// In the page's copy of the map; 0 where pictures are shown.
  gaussians_held: number;
  map_version: number;
  held_version: number;
  mode: DisplayMode | null;
  camera: CameraMode;
  webgl: WebGlKind;
  /// Number of the last picture shown, 0 = none.
  picture: number;
  status_text: string;
  mask: number;
  paused: boolean;
  finished: boolean;
  session: Session | null;
}

declare global {
  interface Window {
    readonly sgs_state?: PageState;
  }
}

export function publish(describe: () => PageState): void {
  Object.defineProperty(window, "sgs_state", { get: describe });
}
