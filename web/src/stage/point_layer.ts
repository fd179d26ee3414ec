// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
import { BufferAttribute, BufferGeometry, DynamicDrawUsage, Points, ShaderMaterial } from "three";
import type { GaussianStore } from "../data/gaussians";
import { kRecordWords } from "../data/protocol";
import type { MapLayer } from "./layer";

const kVertex = `
attribute vec4 tint;
attribute float size;
uniform float scale;
varying vec3 shade;
void main() {
  vec4 eye = modelViewMatrix * vec4(position, 1.0);
  gl_Position = projectionMatrix * eye;
  gl_PointSize = clamp(size * scale / -eye.z, 1.5, 7.0);
  shade = tint.rgb;
}`;

const kFragment = `
varying vec3 shade;
void main() {
  vec2 offset = gl_PointCoord - 0.5;
  if (dot(offset, offset) > 0.25) discard;
  gl_FragColor = vec4(shade, 1.0);
}`;

/// Centres of the Gaussians as opaque points about as large as what they stand for.
export class PointLayer implements MapLayer {
  readonly object: Points<BufferGeometry, ShaderMaterial>;
  private capacity = 0;

  constructor() {
    const material = new ShaderMaterial({
      vertexShader: kVertex,
      fragmentShader: kFragment,
      uniforms: { scale: { value: 500 } },
    });
    this.object = new Points(new BufferGeometry(), material);
    this.object.frustumCulled = false;
  }

  sync(store: GaussianStore, from: number, to: number): void {
    if (store.capacity !== this.capacity) {
      this.allocate(store.capacity);
      [from, to] = [0, store.count];
    }
    const geometry = this.object.geometry;
    geometry.setDrawRange(0, store.count);
    if (from >= to) return;
    const place = geometry.getAttribute("position") as BufferAttribute;
    const tint = geometry.getAttribute("tint") as BufferAttribute;
    const size = geometry.getAttribute("size") as BufferAttribute;
    const tint_words = new Uint32Array((tint.array as Uint8Array).buffer);
    for (let i = from; i < to; ++i) {
      const at = i * kRecordWords;
      place.array.set(store.floats.subarray(at + 1, at + 4), 3 * i);
      const scales = store.floats.subarray(at + 4, at + 7);
      // The two larger axes span the surface piece that a Gaussian stands for.
      const smallest = Math.min(scales[0]!, scales[1]!, scales[2]!);
      size.array[i] = scales[0]! + scales[1]! + scales[2]! - smallest;
      tint_words[i] = store.words[at + 11]!;
    }
    for (const attribute of [place, tint, size]) {
      attribute.addUpdateRange(from * attribute.itemSize, (to - from) * attribute.itemSize);
      attribute.needsUpdate = true;
    }
  }

  resize(height_px: number, fov_y_rad: number): void {
    this.object.material.uniforms["scale"]!.value = height_px / (2 * Math.tan(fov_y_rad / 2));
  }

  dispose(): void {
    this.object.geometry.dispose();
    this.object.material.dispose();
  }

  private allocate(capacity: number): void {
    this.capacity = capacity;
    this.object.geometry.dispose();
    const geometry = new BufferGeometry();
    const attribute = (array: Float32Array | Uint8Array, size: number, normalized = false) => {
      const made = new BufferAttribute(array, size, normalized);
      made.setUsage(DynamicDrawUsage);
      return made;
    };
    geometry.setAttribute("position", attribute(new Float32Array(3 * capacity), 3));
    geometry.setAttribute("tint", attribute(new Uint8Array(4 * capacity), 4, true));
    geometry.setAttribute("size", attribute(new Float32Array(capacity), 1));
    this.object.geometry = geometry;
  }
}
