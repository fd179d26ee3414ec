// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
import { PackedSplats, SparkRenderer, SplatMesh, setPackedSplat } from "@sparkjsdev/spark";
import { Group, type WebGLRenderer } from "three";
import type { GaussianStore } from "../data/gaussians";
import { kRecordWords } from "../data/protocol";
import type { MapLayer } from "./layer";

/// The map as Gaussian splats, sorted and drawn by spark.
export class SplatLayer implements MapLayer {
  readonly object = new Group();
  private packed: PackedSplats | null = null;
  private mesh: SplatMesh | null = null;
  private readonly spark: SparkRenderer;
  private capacity = 0;

  constructor(renderer: WebGLRenderer, changed: () => void) {
    // The map's splats are trained with a screen-space low-pass of 0.3 px^2 and no level of detail.
    this.spark = new SparkRenderer({
      renderer,
      onDirty: changed,
      enableLod: false,
      sortRadial: false,
      preBlurAmount: 0.3,
      blurAmount: 0,
    });
    this.object.add(this.spark);
  }

  sync(store: GaussianStore, from: number, to: number): void {
    if (store.capacity !== this.capacity) {
      this.allocate(store.capacity);
      [from, to] = [0, store.count];
    }
    const { packed, mesh } = this;
    if (!packed?.packedArray || !mesh) return;
    for (let i = from; i < to; ++i) pack(packed.packedArray, store, i);
    if (packed.numSplats !== store.count) {
      packed.numSplats = store.count;
      mesh.numSplats = store.count;
      mesh.updateMappingVersion();
    }
    packed.needsUpdate = true;
    mesh.updateVersion();
  }

  resize(): void {}

  /// Waits for a sort that is under way: spark would reject its promise, and catches that nowhere.
  dispose(): void {
    this.mesh?.dispose();
    const end = (): void => {
      if (this.spark.sorting) setTimeout(end, 50);
      else this.spark.dispose();
    };
    end();
  }

  private allocate(capacity: number): void {
    if (this.mesh) {
      this.object.remove(this.mesh);
      this.mesh.dispose();
    }
    this.capacity = capacity;
    this.packed = new PackedSplats({ maxSplats: capacity });
    this.packed.packedArray = this.packed.ensureSplats(capacity);
    this.packed.numSplats = 0;
    this.mesh = new SplatMesh({ packedSplats: this.packed, raycastable: false, editable: false });
    this.object.add(this.mesh);
  }
}

function pack(out: Uint32Array, store: GaussianStore, i: number): void {
  const at = i * kRecordWords;
  const f = store.floats;
  const rgba = store.words[at + 11]!;
  // Records hold w x y z, spark wants x y z w.
  setPackedSplat(
    out,
    i,
    f[at + 1]!,
    f[at + 2]!,
    f[at + 3]!,
    f[at + 4]!,
    f[at + 5]!,
    f[at + 6]!,
    f[at + 8]!,
    f[at + 9]!,
    f[at + 10]!,
    f[at + 7]!,
    (rgba >>> 24) / 255,
    (rgba & 255) / 255,
    ((rgba >>> 8) & 255) / 255,
    ((rgba >>> 16) & 255) / 255,
  );
}
