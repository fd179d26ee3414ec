// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
import { harmonicBytes, kRecordWords, type MapDiff } from "./protocol";

const kFirstCapacity = 4096;

/// The page's copy of the map: records of the protocol, densely packed (a removed one is replaced by
/// the last), with the range that changed since the display last looked.
export class GaussianStore {
  /// Record i occupies words [i, i + 1) * kRecordWords.
  floats = new Float32Array(kFirstCapacity * kRecordWords);
  words = new Uint32Array(this.floats.buffer);
  /// Of the spherical harmonics; 0 = none. Their bytes follow the records' slots.
  degree = 0;
  harmonics = new Uint8Array(0);
  count = 0;
  version = 0;
  private slots = new Map<number, number>();
  private dirty_from = Infinity;
  private dirty_to = 0;

  get capacity(): number {
    return this.words.length / kRecordWords;
  }

  clear(): void {
    this.count = 0;
    this.version = 0;
    this.slots.clear();
    this.markAll();
  }

  apply(diff: MapDiff): void {
    if (diff.reset) this.clear();
    if (diff.reset || this.count === 0) this.setDegree(diff.degree);
    this.reserve(this.count + diff.count);
    for (let i = 0; i < diff.count; ++i) this.put(diff, i);
    for (const id of diff.removed) this.remove(id);
    if (diff.last) this.version = diff.version;
  }

  /// Slots [from, to) that changed since the last call; empty where from >= to.
  takeDirty(): [from: number, to: number] {
    const range: [number, number] = [this.dirty_from, Math.min(this.dirty_to, this.count)];
    this.dirty_from = Infinity;
    this.dirty_to = 0;
    return range;
  }

  markAll(): void {
    this.dirty_from = 0;
    this.dirty_to = Infinity;
  }

  /// Mean position (of at most 4096 Gaussians) and RMS distance from it.
  extent(): { centre: [number, number, number]; radius: number } {
    const centre: [number, number, number] = [0, 0, 0];
    const step = Math.max(1, Math.floor(this.count / 4096));
    let n = 0;
    let squares = 0;
    for (let i = 0; i < this.count; i += step, ++n) {
      for (let k = 0; k < 3; ++k) {
        const value = this.floats[i * kRecordWords + 1 + k]!;
        centre[k]! += value;
        squares += value * value;
      }
    }
    if (n === 0) return { centre, radius: 0 };
    for (let k = 0; k < 3; ++k) {
      centre[k]! /= n;
      squares -= n * centre[k]! * centre[k]!;
    }
    return { centre, radius: Math.sqrt(Math.max(0, squares) / n) };
  }

  private put(diff: MapDiff, i: number): void {
    const source = diff.words.subarray(i * kRecordWords, (i + 1) * kRecordWords);
    const id = source[0]!;
    let slot = this.slots.get(id);
    if (slot === undefined) {
      slot = this.count++;
      this.slots.set(id, slot);
    }
    this.words.set(source, slot * kRecordWords);
    const bytes = harmonicBytes(this.degree);
    if (bytes > 0 && diff.degree === this.degree) {
      this.harmonics.set(diff.harmonics.subarray(i * bytes, (i + 1) * bytes), slot * bytes);
    }
    this.mark(slot);
  }

  private remove(id: number): void {
    const slot = this.slots.get(id);
    if (slot === undefined) return;
    this.slots.delete(id);
    const last = --this.count;
    if (slot === last) return;
    this.words.copyWithin(slot * kRecordWords, last * kRecordWords, (last + 1) * kRecordWords);
    const bytes = harmonicBytes(this.degree);
    this.harmonics.copyWithin(slot * bytes, last * bytes, (last + 1) * bytes);
    this.slots.set(this.words[slot * kRecordWords]!, slot);
    this.mark(slot);
  }

  private mark(slot: number): void {
    this.dirty_from = Math.min(this.dirty_from, slot);
    this.dirty_to = Math.max(this.dirty_to, slot + 1);
  }

  private reserve(count: number): void {
    if (count <= this.capacity) return;
    const words = new Uint32Array(Math.max(count, 2 * this.capacity) * kRecordWords);
    words.set(this.words.subarray(0, this.count * kRecordWords));
    this.words = words;
    this.floats = new Float32Array(words.buffer);
    const harmonics = new Uint8Array(this.capacity * harmonicBytes(this.degree));
    harmonics.set(this.harmonics.subarray(0, this.count * harmonicBytes(this.degree)));
    this.harmonics = harmonics;
  }

  private setDegree(degree: number): void {
    this.degree = degree;
    this.harmonics = new Uint8Array(this.capacity * harmonicBytes(degree));
  }
}
