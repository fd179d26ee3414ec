// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import { PerspectiveCamera, Vector3 } from "three";
import type { Pose } from "../../src/data/protocol";
import { valueText } from "../../src/panel/values";
import { applyPose, forward, poseOf, upward } from "../../src/stage/pose";
import { isSoftwareRenderer } from "../../src/stage/webgl";
import { startTime_s } from "../../src/time";

test("software rasterizers are known by name", () => {
  for (const name of [
    "ANGLE (Google, Vulkan 1.3.0 (SwiftShader Device (Subzero) (0x0000C0DE)), SwiftShader driver)",
    "Mesa/X.org, llvmpipe (LLVM 15.0.6, 256 bits)",
    "ANGLE (Microsoft, Microsoft Basic Render Driver Direct3D11)",
  ]) {
    assert.ok(isSoftwareRenderer(name), name);
  }
  for (const name of ["ANGLE (NVIDIA, NVIDIA GeForce RTX 3060)", "Mali-G78", "Apple GPU"]) {
    assert.ok(!isSoftwareRenderer(name), name);
  }
});

test("poses survive the way through three's camera", () => {
  const pose: Pose = [1, 2, 3, 0.5, -0.5, 0.5, 0.5];
  const camera = new PerspectiveCamera();
  applyPose(camera, pose);
  const looks = camera.getWorldDirection(new Vector3());
  assert.ok(looks.distanceTo(forward(pose)) < 1e-12);
  const up = new Vector3(0, 1, 0).applyQuaternion(camera.quaternion);
  assert.ok(up.distanceTo(upward(pose)) < 1e-12);
  const back = poseOf(camera);
  const sign = Math.sign(back[3]! * pose[3]!);
  pose.forEach((x, i) => assert.ok(Math.abs(x - back[i]! * (i < 3 ? 1 : sign)) < 1e-12));
});

test("values are short, whatever they are", () => {
  assert.equal(valueText(0.123456), "0.1235");
  assert.equal(valueText([1, null, 2.5]), "1 – 2.5");
  assert.equal(valueText("photometric"), "photometric");
  assert.equal(valueText(true), "yes");
  assert.equal(valueText(undefined), "–");
});

test("recordings with the time of day start at zero", () => {
  assert.equal(startTime_s(1305031102.2), 1305031102.2);
  assert.equal(startTime_s(3.5), 0);
  assert.equal(startTime_s(undefined), 0);
});
