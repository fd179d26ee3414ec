// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
import { Matrix4, Vector3, type PerspectiveCamera } from "three";
import type { Path } from "../data/path";
import type { Camera, Pose, Status } from "../data/protocol";
import { stageTheme as theme } from "../theme";
import { position, rotation } from "./pose";

const kFrustumDepth_m = 0.18;
const kMostPathPoints = 4000;

/// Line styles differ by more than colour.
const kPathStyle: Record<Status, { width: number; dash: number[] }> = {
  ok: { width: 2, dash: [] },
  degenerate: { width: 3.5, dash: [] },
  lost: { width: 2, dash: [3, 5] },
};

export interface OverlayScene {
  path: Path;
  tracked: Pose | null;
  status: Status;
  intrinsics: Camera | null;
  show_camera: boolean;
  focus_m: number;
}

/// What is drawn over the map whatever shows it: paths, the camera's frustum, the axes of the world
/// and a scale. Plain 2-D lines, so that it works with pictures and without WebGL.
export class Overlay {
  private readonly context: CanvasRenderingContext2D;
  private readonly clip_from_world = new Matrix4();
  private width = 1;
  private height = 1;

  constructor(private readonly canvas: HTMLCanvasElement) {
    this.context = canvas.getContext("2d")!;
  }

  draw(camera: PerspectiveCamera, scene: OverlayScene): void {
    this.fit();
    camera.updateMatrixWorld();
    this.clip_from_world.multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse);
    this.context.clearRect(0, 0, this.width, this.height);
    this.drawTruth(scene.path);
    this.drawEstimate(scene.path);
    if (scene.show_camera && scene.tracked && scene.intrinsics) {
      this.drawFrustum(scene.tracked, scene.intrinsics, theme()[scene.status]);
    }
    this.drawAxes(camera);
    this.drawScale(camera, scene.focus_m);
  }

  private fit(): void {
    const ratio = Math.min(2, devicePixelRatio);
    this.width = this.canvas.clientWidth;
    this.height = this.canvas.clientHeight;
    const [w, h] = [Math.round(this.width * ratio), Math.round(this.height * ratio)];
    if (this.canvas.width !== w) this.canvas.width = w;
    if (this.canvas.height !== h) this.canvas.height = h;
    this.context.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.context.lineCap = "round";
    this.context.lineJoin = "round";
  }

  /// Screen coordinates; null behind the camera or far outside.
  private project(p: Vector3): [number, number] | null {
    const e = this.clip_from_world.elements;
    const w = e[3]! * p.x + e[7]! * p.y + e[11]! * p.z + e[15]!;
    if (w < 0.02) return null;
    const x = (e[0]! * p.x + e[4]! * p.y + e[8]! * p.z + e[12]!) / w;
    const y = (e[1]! * p.x + e[5]! * p.y + e[9]! * p.z + e[13]!) / w;
    if (Math.abs(x) > 20 || Math.abs(y) > 20) return null;
    return [(0.5 + 0.5 * x) * this.width, (0.5 - 0.5 * y) * this.height];
  }

  private stroke(color: string, width: number, dash: number[] = []): void {
    const c = this.context;
    c.setLineDash(dash);
    // A dark rim keeps lines readable on any map.
    c.strokeStyle = theme().stage;
    c.globalAlpha = 0.55;
    c.lineWidth = width + 2;
    c.stroke();
    c.strokeStyle = color;
    c.globalAlpha = 1;
    c.lineWidth = width;
    c.stroke();
    c.setLineDash([]);
  }

  private write(text: string, x: number, y: number): void {
    const c = this.context;
    c.strokeStyle = theme().stage;
    c.lineWidth = 3;
    c.strokeText(text, x, y);
    c.fillStyle = theme().ink;
    c.fillText(text, x, y);
  }

  private drawTruth(path: Path): void {
    const c = this.context;
    c.beginPath();
    let drawing = false;
    for (const point of thinned(path)) {
      const at = point.truth ? this.project(position(point.truth)) : null;
      if (at && drawing) c.lineTo(...at);
      else if (at) c.moveTo(...at);
      drawing = at !== null;
    }
    this.stroke(theme().truth, 1.5, [6, 5]);
  }

  private drawEstimate(path: Path): void {
    const c = this.context;
    const points = thinned(path).map((p) => ({
      at: this.project(position(p.pose)),
      status: p.status,
    }));
    for (const status of ["ok", "degenerate", "lost"] as const) {
      c.beginPath();
      let drawing = false; // one line per stretch, for dashes to run on
      for (let i = 1; i < points.length; ++i) {
        const [a, b] = [points[i - 1]!, points[i]!];
        const belongs = b.status === status && a.at !== null && b.at !== null;
        if (belongs && !drawing) c.moveTo(...a.at!);
        if (belongs) c.lineTo(...b.at!);
        drawing = belongs;
      }
      this.stroke(theme()[status], kPathStyle[status].width, kPathStyle[status].dash);
    }
  }

  private drawFrustum(pose: Pose, intrinsics: Camera, color: string): void {
    const { fx, fy, cx, cy, width, height } = intrinsics;
    const q = rotation(pose);
    const world = (x: number, y: number, z: number) =>
      this.project(new Vector3(x, y, z).applyQuaternion(q).add(position(pose)));
    const corner = (u: number, v: number) =>
      world(((u - cx) / fx) * kFrustumDepth_m, ((v - cy) / fy) * kFrustumDepth_m, kFrustumDepth_m);
    const tip = world(0, 0, 0);
    const corners = [corner(0, 0), corner(width, 0), corner(width, height), corner(0, height)];
    if (!tip || corners.some((p) => p === null)) return;
    const [a, b, d, e] = corners as [number, number][];
    const c = this.context;
    c.beginPath();
    c.moveTo(...a!);
    for (const p of [b!, d!, e!, a!]) c.lineTo(...p);
    c.globalAlpha = 0.15;
    c.fillStyle = color;
    c.fill();
    for (const p of [a!, b!, d!, e!]) {
      c.moveTo(...tip);
      c.lineTo(...p);
    }
    // A roof says which edge of the image is the upper one.
    const roof = corner(width / 2, -0.28 * height);
    if (roof) {
      c.moveTo(a![0] + 0.3 * (b![0] - a![0]), a![1] + 0.3 * (b![1] - a![1]));
      c.lineTo(...roof);
      c.lineTo(a![0] + 0.7 * (b![0] - a![0]), a![1] + 0.7 * (b![1] - a![1]));
    }
    this.stroke(color, 2);
  }

  private drawAxes(camera: PerspectiveCamera): void {
    const c = this.context;
    const [x0, y0, length] = [34, this.height - 34, 20];
    c.font = "11px ui-monospace, monospace";
    c.textAlign = "center";
    c.textBaseline = "middle";
    const to_eye = camera.quaternion.clone().invert();
    [new Vector3(1, 0, 0), new Vector3(0, 1, 0), new Vector3(0, 0, 1)].forEach((axis, i) => {
      const v = axis.applyQuaternion(to_eye);
      c.beginPath();
      c.moveTo(x0, y0);
      c.lineTo(x0 + length * v.x, y0 - length * v.y);
      this.stroke(theme().ink, 1.5);
      this.write("XYZ"[i]!, x0 + (length + 8) * v.x, y0 - (length + 8) * v.y);
    });
  }

  /// A bar of 1, 2 or 5 times a power of ten at the distance of what is looked at.
  private drawScale(camera: PerspectiveCamera, focus_m: number): void {
    const px_per_m = this.height / (2 * Math.tan((camera.fov * Math.PI) / 360) * focus_m);
    const wish_m = 90 / px_per_m;
    const decade = 10 ** Math.floor(Math.log10(wish_m));
    const length_m = decade * ([5, 2, 1].find((n) => n * decade <= wish_m) ?? 1);
    const [x1, y1] = [this.width - 18, this.height - 20];
    const x0 = x1 - length_m * px_per_m;
    const c = this.context;
    c.beginPath();
    c.moveTo(x0, y1 - 4);
    c.lineTo(x0, y1);
    c.lineTo(x1, y1);
    c.lineTo(x1, y1 - 4);
    this.stroke(theme().ink, 1.5);
    c.textAlign = "center";
    c.textBaseline = "bottom";
    const label = length_m >= 1 ? `${length_m} m` : `${Math.round(length_m * 1000) / 10} cm`;
    this.write(label, (x0 + x1) / 2, y1 - 5);
  }
}

/// All points of a path, or every n-th of a long one; holes are left out.
function thinned(path: Path) {
  const step = Math.max(1, Math.ceil(path.points.length / kMostPathPoints));
  const last = path.points.length - 1;
  return path.points.flatMap((point, i) =>
    point && (i % step === 0 || i === last) ? [point] : [],
  );
}
