// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
import {
  PackedSplats,
  SparkRenderer,
  SplatMesh,
  setPackedSplat,
  utils as spark_utils,
} from "@sparkjsdev/spark";
import { Group, type Texture, type WebGLRenderer } from "three";
import type { GaussianStore } from "../data/gaussians";
import { harmonicBytes, kRecordWords } from "../data/protocol";
import type { MapLayer } from "./layer";

/// Numbers of one degree per Gaussian, words that spark packs them into, and how.
const kLevels = [
  { floats: 9, words: 2, encode: spark_utils.encodeSh1Rgb },
  { floats: 15, words: 4, encode: spark_utils.encodeSh2Rgb },
  { floats: 21, words: 4, encode: spark_utils.encodeSh3Rgb },
] as const;

/// The map as Gaussian splats, sorted and drawn by spark.
export class SplatLayer implements MapLayer {
  readonly object = new Group();
  private packed: PackedSplats | null = null;
  private mesh: SplatMesh | null = null;
  private readonly spark: SparkRenderer;
  private capacity = 0;
  private degree = 0;

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
    if (store.capacity !== this.capacity || store.degree !== this.degree) {
      this.allocate(store.capacity, store.degree);
      [from, to] = [0, store.count];
    }
    const { packed, mesh } = this;
    if (!packed?.packedArray || !mesh) return;
    for (let i = from; i < to; ++i) pack(packed.packedArray, store, i);
    this.syncHarmonics(store, from, to);
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

  /// Coefficients go into textures of spark's, which it makes when they are first drawn.
  private syncHarmonics(store: GaussianStore, from: number, to: number): void {
    const { packed } = this;
    if (!packed || store.degree === 0) return;
    const bytes = harmonicBytes(store.degree);
    let first = 0;
    for (const [k, level] of kLevels.slice(0, store.degree).entries()) {
      const array = packed.ensureSplatsSh(k + 1, this.capacity);
      array.fill(0, from * level.words, to * level.words);
      const values = new Float32Array(level.floats);
      for (let i = from; i < to; ++i) {
        for (let n = 0; n < level.floats; ++n) {
          values[n] = store.harmonics[i * bytes + first + n]! / 128 - 1;
        }
        level.encode(array, i, values);
      }
      const texture = packed.extra[`sh${k + 1}Texture`] as { value: Texture } | undefined;
      if (texture) texture.value.needsUpdate = true;
      first += level.floats;
    }
  }

  private allocate(capacity: number, degree: number): void {
    if (this.mesh) {
      this.object.remove(this.mesh);
      this.mesh.dispose();
    }
    this.capacity = capacity;
    this.degree = degree;
    this.packed = new PackedSplats({ maxSplats: capacity });
    this.packed.packedArray = this.packed.ensureSplats(capacity);
    this.packed.numSplats = 0;
    // Before the mesh: spark builds its shader for what is there then.
    for (let level = 1; level <= degree; ++level) this.packed.ensureSplatsSh(level, capacity);
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
