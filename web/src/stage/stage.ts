// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
import { Scene, Vector3, WebGLRenderer } from "three";
import type { GaussianStore } from "../data/gaussians";
import type { Path } from "../data/path";
import type { Camera, Hello, MapSubscription, Picture, Request, State } from "../data/protocol";
import { need } from "../dom";
import { CameraRig, type CameraMode } from "./camera_rig";
import type { MapLayer } from "./layer";
import { Overlay, type OverlayScene } from "./overlay";
import { PictureLayer } from "./picture_layer";
import { PointLayer } from "./point_layer";
import { detectWebGl, type WebGlKind } from "./webgl";

export const kDisplayModes = ["splats", "picture", "points"] as const;
export type DisplayMode = (typeof kDisplayModes)[number];

/// The large view: the map in one of three display modes, and the drawing over it. Draws only when
/// something changed, so that an idle page costs nothing.
export class Stage {
  readonly webgl: WebGlKind = detectWebGl();
  readonly rig: CameraRig;
  readonly picture: PictureLayer;
  private readonly gl_canvas = need<HTMLCanvasElement>("gl");
  private readonly picture_canvas = need<HTMLCanvasElement>("picture");
  private readonly overlay_canvas = need<HTMLCanvasElement>("overlay");
  private readonly overlay = new Overlay(this.overlay_canvas);
  private readonly scene = new Scene();
  private renderer: WebGLRenderer | null = null;
  private layer: MapLayer | null = null;
  private mode_: DisplayMode | null = null;
  private intrinsics: Camera | null = null;
  private state: State | null = null;
  private frame_requested = false;
  private map_version = -1;
  private synced_count = 0;

  constructor(
    private readonly store: GaussianStore,
    private readonly path: Path,
    send: (request: Request) => boolean,
  ) {
    this.rig = new CameraRig(this.overlay_canvas, () => this.cameraMoved());
    this.picture = new PictureLayer(this.picture_canvas, send, () => this.requestDraw());
    new ResizeObserver(() => this.resize()).observe(this.overlay_canvas);
  }

  get mode(): DisplayMode | null {
    return this.mode_;
  }

  /// What the server has to send for the mode.
  get subscription(): MapSubscription {
    return this.mode_ === null || this.mode_ === "picture" ? "none" : this.mode_;
  }

  /// Modes that work in this browser.
  get available(): DisplayMode[] {
    return this.webgl === "none" ? ["picture"] : [...kDisplayModes];
  }

  async setMode(mode: DisplayMode): Promise<void> {
    if (mode === this.mode_) return;
    this.mode_ = mode;
    this.dropLayer();
    this.picture.reset();
    this.gl_canvas.hidden = mode === "picture";
    this.picture_canvas.hidden = mode !== "picture";
    if (mode === "points") this.addLayer(new PointLayer());
    if (mode === "splats") {
      // A large library that the other modes do without.
      const { SplatLayer } = await import("./splat_layer");
      if (this.mode_ === "splats") {
        this.addLayer(new SplatLayer(this.makeRenderer(), () => this.requestDraw()));
      }
    }
    this.cameraMoved();
  }

  setCameraMode(mode: CameraMode): void {
    this.rig.setMode(mode);
  }

  start(hello: Hello): void {
    this.intrinsics = hello.camera;
    this.rig.start(hello.up, hello.camera);
    this.restart();
  }

  /// Which way is up became known.
  standUpright(up: [number, number, number]): void {
    this.rig.standUpright(up);
  }

  /// The same run again after a lost connection: the viewpoint stays.
  restart(): void {
    this.map_version = -1;
    this.state = null;
    this.picture.reset();
    this.requestDraw();
  }

  setState(state: State): void {
    this.state = state;
    if (state.pose) this.rig.setTracked(state.pose);
    if (this.mode_ === "picture" && state.map_version !== this.map_version) {
      this.picture.request(this.rig.camera);
    }
    this.map_version = state.map_version;
    this.requestDraw();
  }

  /// The store changed.
  mapChanged(): void {
    this.requestDraw();
  }

  pathChanged(): void {
    this.requestDraw();
  }

  receivePicture(picture: Picture): void {
    if (this.mode_ !== "picture") return;
    void this.picture.receive(picture, this.rig.camera);
  }

  overview(): void {
    const { centre, radius } = this.store.extent();
    if (radius > 0) {
      this.rig.overview(new Vector3(...centre), radius);
      return;
    }
    // Without a copy of the map, what the camera saw along its path has to do.
    const places = this.path.points.flatMap((p) => (p ? [new Vector3(...p.pose.slice(0, 3))] : []));
    if (places.length === 0) return;
    const mean = places.reduce((a, b) => a.add(b), new Vector3()).divideScalar(places.length);
    const reach = Math.max(...places.map((p) => p.distanceTo(mean)));
    this.rig.overview(mean, reach + 1);
  }

  requestDraw(): void {
    if (this.frame_requested) return;
    this.frame_requested = true;
    requestAnimationFrame(() => {
      this.frame_requested = false;
      this.draw();
    });
  }

  /// What is on display, the drawing included.
  snapshot(): HTMLCanvasElement {
    this.draw();
    const out = document.createElement("canvas");
    const source = this.overlay_canvas;
    [out.width, out.height] = [source.width, source.height];
    const context = out.getContext("2d")!;
    context.fillStyle = getComputedStyle(need("stage")).backgroundColor;
    context.fillRect(0, 0, out.width, out.height);
    const map = this.mode_ === "picture" ? this.picture_canvas : this.gl_canvas;
    for (const layer of [map, source]) context.drawImage(layer, 0, 0, out.width, out.height);
    return out;
  }

  private draw(): void {
    this.syncLayer();
    if (this.renderer && this.layer) this.renderer.render(this.scene, this.rig.camera);
    const over_picture = this.mode_ === "picture" ? this.picture.shown_camera : null;
    this.overlay.draw(over_picture ?? this.rig.camera, this.overlayScene());
  }

  private overlayScene(): OverlayScene {
    return {
      path: this.path,
      tracked: this.state?.pose ?? null,
      status: this.state?.status ?? "ok",
      intrinsics: this.intrinsics,
      show_camera: this.rig.mode !== "first",
      focus_m: this.rig.focusDistance_m,
    };
  }

  private cameraMoved(): void {
    if (this.mode_ === "picture") this.picture.request(this.rig.camera);
    this.layer?.resize(this.gl_canvas.height, (this.rig.camera.fov * Math.PI) / 180);
    this.requestDraw();
  }

  private syncLayer(): void {
    if (!this.layer) return;
    const count = this.store.count;
    const [from, to] = this.store.takeDirty();
    if (from < to || count !== this.synced_count) this.layer.sync(this.store, from, to);
    this.synced_count = count;
  }

  private addLayer(layer: MapLayer): void {
    this.makeRenderer();
    this.layer = layer;
    this.scene.add(layer.object);
    this.store.markAll();
    this.resize();
  }

  private dropLayer(): void {
    if (!this.layer) return;
    this.scene.remove(this.layer.object);
    this.layer.dispose();
    this.layer = null;
    this.renderer?.clear();
  }

  private makeRenderer(): WebGLRenderer {
    if (!this.renderer) {
      this.renderer = new WebGLRenderer({ canvas: this.gl_canvas, antialias: false, alpha: true });
      this.resize();
    }
    return this.renderer;
  }

  private resize(): void {
    const { clientWidth: width, clientHeight: height } = this.overlay_canvas;
    if (width === 0 || height === 0) return;
    // Software WebGL pays for every pixel.
    const ratio = this.webgl === "software" ? 1 : Math.min(2, devicePixelRatio);
    this.renderer?.setPixelRatio(ratio);
    this.renderer?.setSize(width, height, false);
    this.rig.resize(width / height);
    this.cameraMoved();
  }
}
