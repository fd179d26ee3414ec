// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
import { indexAt, onMoment, showMoment } from "./moment.mjs";
import { orbitCamera, yawAlong } from "./orbit_camera.mjs";
import { makeSurface } from "./surface.mjs";
import { cross, mix } from "./vec.mjs";

/** @import { Moment } from "./moment.mjs" */
/** @import { Camera, View } from "./orbit_camera.mjs" */
/** @import { PackedDiscs } from "./surface.mjs" */
/** @import { Vec } from "./vec.mjs" */

/** A column of numbers along the path; null = not measured. */
/** @typedef {(number | null)[] | null} Column */
/** @typedef {{ color: number, path: number[], time: number[], error: Column, unseen: Column }} Run */
/** What report/scene.cc writes beside the canvas. Errors in centimetres. */
/**
 * @typedef {{
 *   up: Vec, across: Vec, low: Vec, high: Vec, points: PackedDiscs, keyframes: number[][],
 *   truth: number[], error_max: number | null, runs: Run[],
 * }} SceneData
 */

const kHeatSteps = 9;

/**
 * The 3-D view: the map, paths, keyframes, on a 2-D canvas.
 *
 * @type {(box: Element) => void}
 */
export function makeScene(box) {
  /** @type {SceneData} */
  const data = JSON.parse(box.querySelector("script")?.textContent ?? "");
  const canvas = /** @type {HTMLCanvasElement} */ (box.querySelector("canvas"));
  const ctx = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
  const layer = document.createElement("canvas");
  let layer_shows = "";

  const centre = mix([0.5, data.low], [0.5, data.high]);
  const radius = Math.hypot(...mix([1, data.high], [-1, data.low])) / 2 || 1;
  const subject = {
    up: data.up,
    across: data.across,
    away: cross(data.up, data.across),
    centre,
    radius,
  };
  const surface = makeSurface(data.points, data.runs[0].path, radius);

  /** @type {View} */
  const start = {
    yaw: yawAlong(subject, data.keyframes) + 0.6,
    pitch: 0.65,
    zoom: 1,
    pan: [0, 0, 0],
  };
  let view = { ...start };
  /** @type {Moment} */
  let moment = null;
  let pending = false;
  let held = false;

  /** @type {(name: string) => boolean} */
  const on = (name) => {
    const input = box.querySelector(`input[name=${name}]`);
    return !(input instanceof HTMLInputElement) || input.checked;
  };
  /** @type {(w: number, h: number) => Camera} */
  const camera = (w, h) => orbitCamera(subject, view, w, h);
  const pixelRatio = () => Math.min(2, devicePixelRatio || 1);

  // At the page's own resolution, also where the screen's is finer, and at half of it while the
  // pointer turns it: it is the slow part.
  /** @type {(w: number, h: number) => void} */
  function drawSurface(w, h) {
    const [lw, lh] = [canvas.clientWidth, canvas.clientHeight].map((v) =>
      Math.max(1, Math.round(held ? v / 2 : v)),
    );
    const wanted = JSON.stringify([lw, lh, view]);
    if (layer_shows !== wanted) {
      [layer.width, layer.height, layer_shows] = [lw, lh, wanted];
      layer.getContext("2d")?.putImageData(surface.image(camera(lw, lh)), 0, 0);
    }
    ctx.drawImage(layer, 0, 0, w, h);
  }

  /** @type {(cam: Camera, path: number[], colours: string | string[], width: number) => void} */
  function polyline(cam, path, colours, width) {
    ctx.lineWidth = width;
    let last = null;
    let colour = null;
    for (let i = 0; i < path.length; i += 3) {
      const p = cam.project(path.slice(i, i + 3));
      const next = typeof colours === "string" ? colours : colours[i / 3];
      if (next !== colour || !last || !p) {
        if (colour) ctx.stroke();
        ctx.beginPath();
        ctx.strokeStyle = colour = next;
        if (last) ctx.moveTo(last[0], last[1]);
      }
      if (p) last ? ctx.lineTo(p[0], p[1]) : ctx.moveTo(p[0], p[1]);
      last = p;
    }
    ctx.stroke();
  }

  /** @type {(cam: Camera, pose: number[], size: number, colour: string, width: number) => void} */
  function frustum(cam, pose, size, colour, width) {
    const at = pose.slice(0, 3);
    const [x, y, z] = [0, 1, 2].map((k) => [pose[3 + k], pose[6 + k], pose[9 + k]]);
    /** @type {(a: number, b: number) => Vec} */
    const corner = (a, b) =>
      mix([1, at], [0.8 * a * size, x], [0.6 * b * size, y], [1.2 * size, z]);
    const corners = [corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)];
    for (const c of corners) polyline(cam, [...at, ...c], colour, width);
    polyline(cam, [...corners, corners[0]].flat(), colour, width);
  }

  /** Custom properties of the page's palette. */
  /** @typedef {(name: string) => string} Paint */

  /** @type {(run: Run, paint: Paint) => string | string[]} */
  function colours(run, paint) {
    const by_weight = box.querySelector("select")?.value === "unseen";
    const values = by_weight ? run.unseen : run.error;
    const top = by_weight ? 1 : data.error_max;
    if (data.runs.length > 1 || !values || !top) return paint(`c${run.color}`);
    const steps = Array.from({ length: kHeatSteps }, (_, k) => paint(`h${k}`));
    const none = paint("c5");
    return values.map((v) =>
      v === null
        ? none
        : steps[Math.min(kHeatSteps - 1, Math.max(0, Math.floor((kHeatSteps * v) / top)))],
    );
  }

  function draw() {
    pending = false;
    const ratio = pixelRatio();
    const w = (canvas.width = Math.round(canvas.clientWidth * ratio));
    const h = (canvas.height = Math.round(canvas.clientHeight * ratio));
    if (!w || !h) return;
    const style = getComputedStyle(document.documentElement);
    /** @type {Paint} */
    const paint = (name) => style.getPropertyValue(`--${name}`).trim();
    const cam = camera(w, h);
    if (on("map") && surface.count) drawSurface(w, h);
    const size = 0.035 * radius;
    if (on("cameras"))
      for (const pose of data.keyframes) frustum(cam, pose, size, paint("muted"), ratio);
    if (on("truth")) {
      polyline(cam, data.truth, paint("surface"), 8 * ratio);
      polyline(cam, data.truth, paint("c5"), 6 * ratio);
    }
    for (const run of data.runs) {
      if (!on("truth")) polyline(cam, run.path, paint("surface"), 5 * ratio);
      polyline(cam, run.path, colours(run, paint), 2.6 * ratio);
    }
    if (moment === null) return;
    for (const run of data.runs) mark(cam, run, indexAt(run.time, moment), paint, ratio);
  }

  /** @type {(cam: Camera, run: Run, i: number, paint: Paint, ratio: number) => void} */
  function mark(cam, run, i, paint, ratio) {
    const p = cam.project(run.path.slice(3 * i, 3 * i + 3));
    if (!p) return;
    ctx.beginPath();
    ctx.arc(p[0], p[1], 6 * ratio, 0, 7);
    ctx.fillStyle = paint(`c${run.color}`);
    ctx.fill();
    ctx.lineWidth = 2 * ratio;
    ctx.strokeStyle = paint("surface");
    ctx.stroke();
  }

  const redraw = () => {
    if (!pending) requestAnimationFrame(draw);
    pending = true;
  };
  /** @type {(yaw: number, pitch: number) => void} */
  const turn = (yaw, pitch) => {
    view.yaw += yaw;
    view.pitch = Math.min(1.57, Math.max(-1.57, view.pitch + pitch));
    redraw();
  };
  /** @type {(factor: number) => void} */
  const zoom = (factor) => {
    view.zoom = Math.min(30, Math.max(0.3, view.zoom * factor));
    redraw();
  };
  /** @type {(changes: Partial<View>) => void} */
  const look = (changes) => {
    view = { ...start, ...changes };
    redraw();
  };

  canvas.addEventListener("pointerdown", (e) => {
    canvas.setPointerCapture(e.pointerId);
    canvas.focus({ preventScroll: true });
    held = true;
  });
  const release = () => {
    held = false;
    redraw();
  };
  canvas.addEventListener("pointerup", release);
  canvas.addEventListener("pointercancel", release);
  canvas.addEventListener("pointermove", (e) => {
    if (!e.buttons) return;
    if (e.buttons > 1 || e.shiftKey) {
      const cam = camera(canvas.width, canvas.height);
      const k = cam.scale * pixelRatio();
      view.pan = mix([1, view.pan], [-k * e.movementX, cam.right], [k * e.movementY, cam.up]);
      redraw();
    } else {
      turn(-0.008 * e.movementX, 0.008 * e.movementY);
    }
  });
  canvas.addEventListener("contextmenu", (e) => e.preventDefault());
  const options = { passive: false };
  canvas.addEventListener(
    "wheel",
    (e) => {
      if (document.activeElement !== canvas) return;
      e.preventDefault();
      zoom(Math.exp(-0.0015 * e.deltaY));
    },
    options,
  );
  /** @type {Record<string, () => void>} */
  const keys = {
    ArrowLeft: () => turn(0.1, 0),
    ArrowRight: () => turn(-0.1, 0),
    ArrowUp: () => turn(0, 0.1),
    ArrowDown: () => turn(0, -0.1),
    "+": () => zoom(1.15),
    "-": () => zoom(1 / 1.15),
    0: () => look({}),
  };
  canvas.addEventListener("keydown", (e) => {
    const act = keys[e.key];
    if (!act) return;
    e.preventDefault();
    act();
  });
  /** @type {Record<string, Partial<View>>} */
  const views = { above: { yaw: 0, pitch: 1.57 }, side: { yaw: 0, pitch: 0.02 }, reset: {} };
  for (const button of box.querySelectorAll("button"))
    button.addEventListener("click", () => look(views[button.name]));
  for (const input of box.querySelectorAll("input[type=checkbox], select"))
    input.addEventListener("change", redraw);

  const clock = box.querySelector("input[type=range]");
  const output = box.querySelector("output");
  if (clock instanceof HTMLInputElement)
    clock.addEventListener("input", () => showMoment(Number(clock.value)));
  onMoment((t) => {
    moment = t;
    redraw();
    if (t === null || !(clock instanceof HTMLInputElement) || !output) return;
    clock.value = String(t);
    output.textContent = reading(data.runs, t);
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
  new ResizeObserver(redraw).observe(canvas);
}

/**
 * What is said of one moment: its time and, of a single run, what was measured then.
 *
 * @type {(runs: Run[], t: number) => string}
 */
export function reading(runs, t) {
  const [run] = runs;
  const i = indexAt(run.time, t);
  const error = runs.length > 1 ? null : run.error?.[i];
  const unseen = runs.length > 1 ? null : run.unseen?.[i];
  let text = `${t.toFixed(2)} s`;
  if (error != null) text += ` · error ${error.toPrecision(2)} cm`;
  if (unseen != null) text += ` · unseen ${unseen.toFixed(2)}`;
  return text;
}
