// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
import type { Session } from "./protocol";

/// With a capital and a full stop; nothing stays nothing.
export function sentence(text: string): string {
  if (text === "") return "";
  const end = /[.!?]$/.test(text) ? "" : ".";
  return text[0]!.toUpperCase() + text.slice(1) + end;
}

/// How many frames come, and what becomes of those that are not used.
export function droppedWords(
  note: Pick<Session, "camera_fps" | "dropped" | "left_out" | "why_dropped">,
): string {
  const parts = [];
  if (note.camera_fps !== null) parts.push(`${note.camera_fps.toFixed(0)} frames/s come`);
  if (note.dropped > 0) {
    const why = note.why_dropped ? `: ${note.why_dropped}` : "";
    parts.push(`${note.dropped} dropped${why}`);
  }
  if (note.left_out > 0) parts.push(`${note.left_out} left out while paused`);
  return parts.join("; ");
}
