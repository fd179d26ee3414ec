// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
import { kStatuses, type PathChunk, type Pose, type State, type Status } from "./protocol";

export interface PathPoint {
  pose: Pose;
  truth: Pose | null;
  status: Status;
}

/// Estimated and true poses by frame; frames that no message told of are holes.
export class Path {
  readonly points: (PathPoint | undefined)[] = [];

  clear(): void {
    this.points.length = 0;
  }

  /// Replaces the path from the chunk's first frame on.
  addChunk(chunk: PathChunk): void {
    this.points.length = Math.min(this.points.length, chunk.first);
    chunk.estimate.forEach((pose, i) => {
      // A status beyond those we know marks a number that no frame has.
      const status = kStatuses[chunk.status[i] ?? 0];
      if (!pose || !status) return;
      this.points[chunk.first + i] = { pose, truth: chunk.truth[i] ?? null, status };
    });
  }

  addState(state: State): void {
    // Time runs backwards where a replay starts again.
    this.points.length = Math.min(this.points.length, state.frame + 1);
    if (!state.pose) return;
    this.points[state.frame] = { pose: state.pose, truth: state.truth, status: state.status };
  }
}
