// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
import { PerspectiveCamera, Vector3 } from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import type { Camera, Pose } from "../data/protocol";
import { applyPose, forward, position, upward } from "./pose";

export const kCameraModes = ["follow", "orbit", "first"] as const;
export type CameraMode = (typeof kCameraModes)[number];

const kFovY_deg = 50;
/// How far in front of the camera the point lies that we look at, and where we stand: behind, above.
const kLookAhead_m = 0.8;
const kBehind_m = 1.6;
const kAbove_m = 0.9;
/// Directions that differ by less are one.
const kSameUp = 1e-3;

/// The eye of the page: moves with the tracked camera, freely, or is the tracked camera.
export class CameraRig {
  readonly camera = new PerspectiveCamera(kFovY_deg, 1, 0.02, 500);
  private controls: OrbitControls;
  private mode_: CameraMode = "follow";
  private tracked: Pose | null = null;
  private intrinsics: Camera | null = null;
  private up_known = false;

  constructor(
    private readonly element: HTMLElement,
    private readonly changed: () => void,
  ) {
    this.controls = this.makeControls();
  }

  get mode(): CameraMode {
    return this.mode_;
  }

  /// A new run: the old viewpoint means nothing in its world.
  start(up: [number, number, number] | null, intrinsics: Camera): void {
    this.tracked = null;
    this.intrinsics = intrinsics;
    this.up_known = up !== null;
    if (up) this.setUp(new Vector3(...up));
  }

  /// Which way is up became known: the view is righted about what it looks at.
  standUpright(up: [number, number, number]): void {
    const wanted = new Vector3(...up).normalize();
    if (this.camera.up.distanceTo(wanted) < kSameUp) return;
    const target = this.controls.target.clone();
    this.up_known = true;
    this.setUp(wanted);
    this.controls.target.copy(target);
    if (this.mode_ !== "first") this.controls.update();
    this.changed();
  }

  setMode(mode: CameraMode): void {
    const leaves_first = this.mode_ === "first" && mode !== "first";
    this.mode_ = mode;
    this.controls.enabled = mode !== "first";
    this.updateLens();
    if (leaves_first || mode === "first") this.home();
    this.changed();
  }

  /// The tracked camera moved.
  setTracked(pose: Pose): void {
    const before = this.tracked;
    this.tracked = pose;
    if (!before) {
      if (!this.up_known) this.setUp(upward(pose));
      this.home();
    } else if (this.mode_ === "first") {
      applyPose(this.camera, pose);
    } else if (this.mode_ === "follow") {
      const step = position(pose).sub(position(before));
      this.camera.position.add(step);
      this.controls.target.add(step);
      // The point looked at drifts to where the camera now looks, slowly: turns stay calm.
      const gap = this.lookPoint(pose).sub(this.controls.target).multiplyScalar(0.06);
      this.controls.target.add(gap);
      this.camera.position.add(gap);
      this.controls.update();
    } else {
      return;
    }
    this.changed();
  }

  /// Back to the standard viewpoint of the mode.
  home(): void {
    if (!this.tracked) return;
    if (this.mode_ === "first") {
      applyPose(this.camera, this.tracked);
    } else {
      const up = this.camera.up;
      const ahead = forward(this.tracked);
      // Where the camera looks straight down or up, its own upper edge says where "behind" is.
      const level = ahead.clone().addScaledVector(up, -ahead.dot(up));
      const back = level.length() > 0.3 ? level : upward(this.tracked);
      back.addScaledVector(up, -back.dot(up)).normalize();
      const side = new Vector3().crossVectors(back, up);
      this.controls.target.copy(this.lookPoint(this.tracked));
      this.camera.position
        .copy(position(this.tracked))
        .addScaledVector(back, -kBehind_m)
        .addScaledVector(up, kAbove_m)
        .addScaledVector(side, 0.35 * kBehind_m);
      this.controls.update();
    }
    this.changed();
  }

  /// Backs off until a sphere is in view.
  overview(centre: Vector3, radius: number): void {
    if (this.mode_ === "first" || radius <= 0) return;
    const away = this.camera.position.clone().sub(this.controls.target).normalize();
    const half = Math.min(1, this.camera.aspect) * Math.tan((this.camera.fov * Math.PI) / 360);
    this.controls.target.copy(centre);
    this.camera.position.copy(centre).addScaledVector(away, (1.7 * radius) / half);
    this.controls.update();
    this.changed();
  }

  resize(aspect: number): void {
    this.camera.aspect = aspect;
    this.updateLens();
  }

  /// Distance of what the camera looks at, metres.
  get focusDistance_m(): number {
    return this.mode_ === "first" ? kLookAhead_m : this.controls.getDistance();
  }

  private lookPoint(pose: Pose): Vector3 {
    return position(pose).addScaledVector(forward(pose), kLookAhead_m);
  }

  /// First person shows at least the image of the tracked camera.
  private updateLens(): void {
    const camera = this.camera;
    camera.fov = kFovY_deg;
    if (this.mode_ === "first" && this.intrinsics) {
      const { fx, fy, width, height } = this.intrinsics;
      const half = Math.max(height / (2 * fy), width / (2 * fx) / camera.aspect);
      camera.fov = (2 * Math.atan(half) * 180) / Math.PI;
    }
    camera.updateProjectionMatrix();
  }

  private setUp(up: Vector3): void {
    this.camera.up.copy(up).normalize();
    // The controls learn what is up only when they are made.
    this.controls.dispose();
    this.controls = this.makeControls();
    this.controls.enabled = this.mode_ !== "first";
  }

  private makeControls(): OrbitControls {
    const controls = new OrbitControls(this.camera, this.element);
    controls.addEventListener("change", () => this.changed());
    controls.zoomSpeed = 1.5;
    controls.minDistance = 0.05;
    controls.maxDistance = 200;
    return controls;
  }
}
