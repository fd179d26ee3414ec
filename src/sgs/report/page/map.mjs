// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
import { kFragment, kVertex } from "./splat_shaders.mjs";
import { kRecord, medianOf, orderByDepth } from "./splats.mjs";
import { decoded, dot, minus, mix, turned } from "./vec.mjs";

/** @import { Vec } from "./vec.mjs" */

/** What report/map_page.cc writes: poses (position, then the rotation row by row), upwards, and
 * width, height, fx, fy, cx, cy. */
/** @typedef {{ cameras: number[][], up: Vec, camera?: number[] }} Page */

/** @type {(id: string) => HTMLElement} */
const byId = (id) => /** @type {HTMLElement} */ (document.getElementById(id));
/** @type {Page} */
const page = JSON.parse(byId("page").textContent ?? "");
const bytes = decoded(byId("splats").textContent ?? "");
const records = new Float32Array(bytes.buffer);
const count = records.length / kRecord;
const canvas = /** @type {HTMLCanvasElement} */ (document.querySelector("canvas"));
const gl = openGl();

function openGl() {
  const context = canvas.getContext("webgl2", { antialias: false, preserveDrawingBuffer: true });
  if (context) return context;
  byId("status").textContent = "This browser does not offer WebGL 2.";
  throw new Error("no WebGL 2");
}

/** @type {(type: number, source: string) => WebGLShader} */
function compiled(type, source) {
  const shader = /** @type {WebGLShader} */ (gl.createShader(type));
  gl.shaderSource(shader, source);
  gl.compileShader(shader);
  if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS))
    throw new Error(gl.getShaderInfoLog(shader) ?? "");
  return shader;
}
const program = gl.createProgram();
gl.attachShader(program, compiled(gl.VERTEX_SHADER, kVertex));
gl.attachShader(program, compiled(gl.FRAGMENT_SHADER, kFragment));
gl.linkProgram(program);
gl.useProgram(program);
/** @type {(name: string) => WebGLUniformLocation | null} */
const uniform = (name) => gl.getUniformLocation(program, name);

/** Bytes as texels of 16 in texture number `unit`, for the sampler `name`. */
/** @type {(unit: number, name: string, data: Uint8Array<ArrayBuffer>) => void} */
function texture(unit, name, data) {
  const kTexels = 2048;
  const rows = Math.max(1, Math.ceil(data.length / 16 / kTexels));
  const padded = new Uint32Array(4 * kTexels * rows);
  padded.set(new Uint32Array(data.buffer));
  gl.activeTexture(gl.TEXTURE0 + unit);
  gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
  gl.texImage2D(
    gl.TEXTURE_2D,
    0,
    gl.RGBA32UI,
    kTexels,
    rows,
    0,
    gl.RGBA_INTEGER,
    gl.UNSIGNED_INT,
    padded,
  );
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
  gl.uniform1i(uniform(name), unit);
}
texture(0, "records", bytes);
texture(1, "harmonics", decoded(byId("harmonics").textContent ?? ""));
gl.uniform1i(uniform("degree"), Number(byId("harmonics").dataset.degree));

/** @type {(name: string, data: Float32Array<ArrayBuffer> | Uint32Array<ArrayBuffer>, per_splat: boolean) => WebGLBuffer} */
function attribute(name, data, per_splat) {
  const buffer = gl.createBuffer();
  const at = gl.getAttribLocation(program, name);
  gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
  gl.bufferData(gl.ARRAY_BUFFER, data, per_splat ? gl.DYNAMIC_DRAW : gl.STATIC_DRAW);
  gl.enableVertexAttribArray(at);
  if (per_splat) gl.vertexAttribIPointer(at, 1, gl.UNSIGNED_INT, 0, 0);
  else gl.vertexAttribPointer(at, 2, gl.FLOAT, false, 0, 0);
  gl.vertexAttribDivisor(at, per_splat ? 1 : 0);
  return buffer;
}
attribute("corner", new Float32Array([-1, -1, 1, -1, -1, 1, 1, 1]), false);
const order = new Uint32Array(count);
const order_buffer = attribute("index", order, true);
gl.enable(gl.BLEND);
gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);

/** The view: a camera at `eye` with axes x right, y down, z forward; dragging turns it about a point
 * `focus` metres ahead. */
/** @typedef {{ eye: Vec, x: Vec, y: Vec, z: Vec, focus: number }} View */
let current = 0;
let pending = false;
let frames = 0;
/** @type {View} */
let view = openedView(Number((location.hash.match(/view=(\d+)/) || [0, 0])[1]));

/** The pose of a recorded camera, counted around; without any, from the middle of the map, backed off. */
/** @type {(number: number) => number[]} */
function pose(number) {
  const { length } = page.cameras;
  current = length ? (number + length) % length : 0;
  if (length) return page.cameras[current];
  const middle = [0, 1, 2].map((k) => medianOf(records, count, (at) => records[at + k]) ?? 0);
  return [...mix([1, middle], [-3, [0, 0, 1]]), 1, 0, 0, 0, 1, 0, 0, 0, 1];
}

/** @type {(number: number) => View} */
function openedView(number) {
  const c = pose(number);
  /** @type {(k: number) => Vec} */
  const axis = (k) => [c[3 + k], c[6 + k], c[9 + k]];
  /** @type {Vec} */
  const eye = [c[0], c[1], c[2]];
  const focus = medianOf(records, 2048, (at) => {
    const depth = dot(axis(2), minus(records.subarray(at, at + 3), eye));
    return depth > 0.1 ? depth : undefined;
  });
  return { eye, x: axis(0), y: axis(1), z: axis(2), focus: focus || 1 };
}

/** @type {(number: number) => void} */
function openView(number) {
  view = openedView(number);
  redraw();
}

function draw() {
  pending = false;
  const ratio = Math.min(2, devicePixelRatio || 1);
  const w = (canvas.width = Math.max(1, Math.round(canvas.clientWidth * ratio)));
  const h = (canvas.height = Math.max(1, Math.round(canvas.clientHeight * ratio)));
  const { eye, x, y, z } = view;
  // The camera's picture fits into the window, whatever its shape.
  const [cw, ch, fx, fy, cx, cy] = page.camera ?? [640, 480, 525, 525, 319.5, 239.5];
  const k = Math.min(w / cw, h / ch);
  gl.viewport(0, 0, w, h);
  gl.clearColor(0, 0, 0, 1);
  gl.clear(gl.COLOR_BUFFER_BIT);
  orderByDepth(records, eye, z, order);
  gl.bindBuffer(gl.ARRAY_BUFFER, order_buffer);
  gl.bufferSubData(gl.ARRAY_BUFFER, 0, order);
  gl.uniformMatrix3fv(
    uniform("R"),
    false,
    [0, 1, 2].flatMap((i) => [x[i], y[i], z[i]]),
  );
  gl.uniform3fv(uniform("eye"), eye);
  gl.uniform4f(
    uniform("lens"),
    k * fx,
    k * fy,
    k * (cx + 0.5 - cw / 2) + w / 2 - 0.5,
    k * (cy + 0.5 - ch / 2) + h / 2 - 0.5,
  );
  gl.uniform2f(uniform("size"), w, h);
  gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, count);
  document.body.dataset.frames = String(++frames);
}
function redraw() {
  if (!pending) requestAnimationFrame(draw);
  pending = true;
}

const target = () => mix([1, view.eye], [view.focus, view.z]);
/** @type {(yaw: number, pitch: number) => void} */
function orbit(yaw, pitch) {
  const about = target();
  /** @type {(v: Vec) => Vec} */
  const turn = (v) => turned(turned(v, page.up, yaw), turned(view.x, page.up, yaw), pitch);
  const [x, y, z] = [turn(view.x), turn(view.y), turn(view.z)];
  view = { ...view, x, y, z, eye: mix([1, about], [-view.focus, z]) };
  redraw();
}
/** @type {(factor: number) => void} */
function zoom(factor) {
  const about = target();
  view.focus = Math.min(1e4, Math.max(0.05, view.focus * factor));
  view.eye = mix([1, about], [-view.focus, view.z]);
  redraw();
}
/** @type {(dx: number, dy: number) => void} */
function pan(dx, dy) {
  const s = view.focus / canvas.clientHeight;
  view.eye = mix([1, view.eye], [-s * dx, view.x], [-s * dy, view.y]);
  redraw();
}

/** @type {Map<number, PointerEvent>} */
const touches = new Map();
canvas.addEventListener("pointerdown", (e) => {
  canvas.setPointerCapture(e.pointerId);
  touches.set(e.pointerId, e);
});
canvas.addEventListener("pointerup", (e) => touches.delete(e.pointerId));
canvas.addEventListener("pointercancel", (e) => touches.delete(e.pointerId));
canvas.addEventListener("pointermove", (e) => {
  const before = touches.get(e.pointerId);
  if (!before) return;
  const dx = e.clientX - before.clientX;
  const dy = e.clientY - before.clientY;
  const other = [...touches.values()].find((t) => t.pointerId !== e.pointerId);
  if (touches.size === 2 && other) {
    // pinch
    /** @type {(t: PointerEvent) => number} */
    const length = (t) => Math.hypot(t.clientX - other.clientX, t.clientY - other.clientY);
    zoom(length(before) / Math.max(1, length(e)));
    pan(dx / 2, dy / 2);
  } else if (e.buttons > 1 || e.shiftKey) {
    pan(dx, dy);
  } else {
    orbit(-0.006 * dx, 0.006 * dy);
  }
  touches.set(e.pointerId, e);
});
canvas.addEventListener("contextmenu", (e) => e.preventDefault());
canvas.addEventListener(
  "wheel",
  (e) => {
    e.preventDefault();
    zoom(Math.exp(0.0015 * e.deltaY));
  },
  { passive: false },
);
/** @type {Record<string, () => void>} */
const keys = {
  ArrowLeft: () => orbit(0.08, 0),
  ArrowRight: () => orbit(-0.08, 0),
  ArrowUp: () => orbit(0, -0.08),
  ArrowDown: () => orbit(0, 0.08),
  "+": () => zoom(1 / 1.15),
  "-": () => zoom(1.15),
  n: () => openView(current + 1),
  p: () => openView(current - 1),
  h: () => document.body.classList.toggle("bare"),
};
addEventListener("keydown", (e) => {
  if (!e.ctrlKey && !e.metaKey) keys[e.key]?.();
});
byId("next").addEventListener("click", () => openView(current + 1));
byId("previous").addEventListener("click", () => openView(current - 1));
document.body.classList.toggle("bare", location.hash.includes("bare"));
new ResizeObserver(redraw).observe(canvas);
redraw();
