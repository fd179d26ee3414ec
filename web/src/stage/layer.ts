// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
import type { Object3D } from "three";
import type { GaussianStore } from "../data/gaussians";

/// One way of showing the map with WebGL.
export interface MapLayer {
  readonly object: Object3D;
  /// Takes over slots [from, to) and the count.
  sync(store: GaussianStore, from: number, to: number): void;
  /// Height of the drawing buffer and the vertical field of view changed.
  resize(height_px: number, fov_y_rad: number): void;
  dispose(): void;
}
