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

  addChunk(chunk: PathChunk): void {
    chunk.estimate.forEach((pose, i) => {
      if (!pose) return;
      this.points[chunk.first + i] = {
        pose,
        truth: chunk.truth[i] ?? null,
        status: kStatuses[chunk.status[i] ?? 0] ?? "ok",
      };
    });
  }

  addState(state: State): void {
    if (!state.pose) return;
    this.points[state.frame] = { pose: state.pose, truth: state.truth, status: state.status };
  }
}
