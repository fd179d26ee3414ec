// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
import { Quaternion, Vector3, type PerspectiveCamera } from "three";
import type { Pose } from "../data/protocol";

/// three's cameras look along -z with y up, ours along +z with y down: half a turn about x.
const kHalfTurnX = new Quaternion(1, 0, 0, 0);

export function position(pose: Pose): Vector3 {
  return new Vector3(pose[0], pose[1], pose[2]);
}

export function rotation(pose: Pose): Quaternion {
  return new Quaternion(pose[3], pose[4], pose[5], pose[6]);
}

/// Direction of a camera axis in the world.
export function forward(pose: Pose): Vector3 {
  return new Vector3(0, 0, 1).applyQuaternion(rotation(pose));
}

export function upward(pose: Pose): Vector3 {
  return new Vector3(0, -1, 0).applyQuaternion(rotation(pose));
}

/// Gives three's camera our pose.
export function applyPose(camera: PerspectiveCamera, pose: Pose): void {
  camera.position.copy(position(pose));
  camera.quaternion.copy(rotation(pose)).multiply(kHalfTurnX);
}

/// Our pose of three's camera.
export function poseOf(camera: PerspectiveCamera): Pose {
  const p = camera.position;
  const q = camera.quaternion.clone().multiply(kHalfTurnX);
  return [p.x, p.y, p.z, q.x, q.y, q.z, q.w];
}
