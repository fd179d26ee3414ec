// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
'use strict';
const byId = id => document.getElementById(id);
const page = JSON.parse(byId('page').textContent);
const bytes = Uint8Array.from(atob(byId('splats').textContent), c => c.charCodeAt(0));
const count = bytes.length / 32, floats = new Float32Array(bytes.buffer);
const canvas = document.querySelector('canvas');
const gl = canvas.getContext('webgl2', {antialias: false, preserveDrawingBuffer: true});
if (!gl) {
  byId('status').textContent = 'This browser does not offer WebGL 2.';
  throw new Error('no WebGL 2');
}

// Records lie in a texture, two texels each; a vertex attribute names the record to draw.
const kVertex = `#version 300 es
precision highp float;
precision highp usampler2D;
uniform usampler2D records;
uniform mat3 R;           // camera from world
uniform vec3 eye;
uniform vec4 lens;        // fx fy cx cy in pixels
uniform vec2 size;        // of the picture in pixels
in vec2 corner;
in uint index;
out vec2 offset;
out vec4 color;
flat out vec3 conic;
void main() {
  gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
  uint width = uint(textureSize(records, 0).x), at = 2u * index;
  uvec4 a = texelFetch(records, ivec2(at % width, at / width), 0);
  ++at;
  uvec4 b = texelFetch(records, ivec2(at % width, at / width), 0);
  vec3 p = R * (uintBitsToFloat(a.xyz) - eye);
  if (p.z < 0.1) return;
  vec3 s = vec3(uintBitsToFloat(a.w), uintBitsToFloat(b.xy));
  vec4 q = normalize((vec4(b.w & 255u, b.w >> 8 & 255u, b.w >> 16 & 255u, b.w >> 24) - 128.0));
  float w = q.x, x = q.y, y = q.z, z = q.w;
  mat3 M = R * mat3(
    1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y),
    2.0 * (x * y - w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + w * x),
    2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y));
  M[0] *= s.x; M[1] *= s.y; M[2] *= s.z;
  // Slopes are clamped a little outside the picture, as in the rasterizer.
  vec2 low = (-0.15 * size - lens.zw) / lens.xy, high = (1.15 * size - lens.zw) / lens.xy;
  vec2 t = clamp(p.xy / p.z, low, high);
  vec3 ju = vec3(lens.x / p.z, 0.0, -lens.x * t.x / p.z);
  vec3 jv = vec3(0.0, lens.y / p.z, -lens.y * t.y / p.z);
  vec3 mu = ju * M, mv = jv * M;
  float A = dot(mu, mu) + 0.3, B = dot(mu, mv), C = dot(mv, mv) + 0.3, det = A * C - B * B;
  color = vec4(b.z & 255u, b.z >> 8 & 255u, b.z >> 16 & 255u, b.z >> 24) / 255.0;
  if (det <= 0.0 || color.a < 1.0 / 255.0) return;
  conic = vec3(C, -B, A) / det;
  // Ellipse on which the opacity falls to 1/255, as a box around it.
  float reach = sqrt(2.0 * log(255.0 * color.a));
  offset = corner * reach * sqrt(vec2(A, C));
  vec2 uv = lens.xy * p.xy / p.z + lens.zw + 0.5 + offset;
  if (any(lessThan(uv - offset, -0.5 * size)) || any(greaterThan(uv - offset, 1.5 * size))) return;
  gl_Position = vec4(2.0 * uv.x / size.x - 1.0, 1.0 - 2.0 * uv.y / size.y, 0.0, 1.0);
}`;
const kFragment = `#version 300 es
precision highp float;
in vec2 offset;
in vec4 color;
flat in vec3 conic;
out vec4 result;
void main() {
  float power = 0.5 * (conic.x * offset.x * offset.x + conic.z * offset.y * offset.y)
              + conic.y * offset.x * offset.y;
  float alpha = min(0.99, color.a * exp(-power));
  if (alpha < 1.0 / 255.0) discard;
  result = vec4(color.rgb * alpha, alpha);
}`;

function compiled(type, source) {
  const shader = gl.createShader(type);
  gl.shaderSource(shader, source);
  gl.compileShader(shader);
  if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw gl.getShaderInfoLog(shader);
  return shader;
}
const program = gl.createProgram();
gl.attachShader(program, compiled(gl.VERTEX_SHADER, kVertex));
gl.attachShader(program, compiled(gl.FRAGMENT_SHADER, kFragment));
gl.linkProgram(program);
gl.useProgram(program);
const uniform = name => gl.getUniformLocation(program, name);

const texels = 2048, rows = Math.max(1, Math.ceil(2 * count / texels));
const padded = new Uint32Array(4 * texels * rows);
padded.set(new Uint32Array(bytes.buffer));
gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32UI, texels, rows, 0, gl.RGBA_INTEGER, gl.UNSIGNED_INT,
              padded);
gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);

function attribute(name, data, perSplat) {
  const buffer = gl.createBuffer(), at = gl.getAttribLocation(program, name);
  gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
  gl.bufferData(gl.ARRAY_BUFFER, data, perSplat ? gl.DYNAMIC_DRAW : gl.STATIC_DRAW);
  gl.enableVertexAttribArray(at);
  if (perSplat) gl.vertexAttribIPointer(at, 1, gl.UNSIGNED_INT, 0, 0);
  else gl.vertexAttribPointer(at, 2, gl.FLOAT, false, 0, 0);
  gl.vertexAttribDivisor(at, perSplat ? 1 : 0);
  return buffer;
}
attribute('corner', new Float32Array([-1, -1, 1, -1, -1, 1, 1, 1]), false);
const order = new Uint32Array(count), depths = new Float32Array(count);
const orderBuffer = attribute('index', order, true);
gl.enable(gl.BLEND);
gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);

// Farthest first: counting sort over 65536 steps of depth.
const bins = new Uint32Array(65537);
function sort(forward, eye) {
  let near = Infinity, far = -Infinity;
  for (let i = 0; i < count; ++i) {
    const d = forward[0] * (floats[8 * i] - eye[0]) + forward[1] * (floats[8 * i + 1] - eye[1])
            + forward[2] * (floats[8 * i + 2] - eye[2]);
    depths[i] = d;
    if (d < near) near = d;
    if (d > far) far = d;
  }
  const scale = 65535 / Math.max(1e-9, far - near);
  bins.fill(0);
  for (let i = 0; i < count; ++i) ++bins[1 + ((far - depths[i]) * scale | 0)];
  for (let b = 1; b < bins.length; ++b) bins[b] += bins[b - 1];
  for (let i = 0; i < count; ++i) order[bins[(far - depths[i]) * scale | 0]++] = i;
  gl.bindBuffer(gl.ARRAY_BUFFER, orderBuffer);
  gl.bufferSubData(gl.ARRAY_BUFFER, 0, order);
}

// The view: a camera at `eye` with axes x right, y down, z forward; dragging turns it about a point
// `focus` metres ahead.
const add = (a, b, s = 1) => [0, 1, 2].map(k => a[k] + s * b[k]);
const cross = (a, b) =>
  [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
function turned(v, axis, angle) {
  const c = Math.cos(angle), s = Math.sin(angle), n = cross(axis, v);
  const d = (axis[0] * v[0] + axis[1] * v[1] + axis[2] * v[2]) * (1 - c);
  return [0, 1, 2].map(k => v[k] * c + n[k] * s + axis[k] * d);
}
let view = null, current = 0, pending = false, frames = 0;

function medianDepth(eye, forward) {
  const d = [];
  for (let i = 0; i < count; i += Math.max(1, count >> 11)) {
    const z = [0, 1, 2].reduce((s, k) => s + forward[k] * (floats[8 * i + k] - eye[k]), 0);
    if (z > 0.1) d.push(z);
  }
  return d.sort((a, b) => a - b)[d.length >> 1] || 1;
}

function openView(number) {
  let c = page.cameras[current = (number + page.cameras.length) % (page.cameras.length || 1)];
  if (!c) {  // no cameras: from the middle of the map, backed off
    const middle = [0, 1, 2].map(k => {
      const v = [];
      for (let i = 0; i < count; ++i) v.push(floats[8 * i + k]);
      return v.sort((a, b) => a - b)[count >> 1] || 0;
    });
    c = [...add(middle, [0, 0, 1], -3), 1, 0, 0, 0, 1, 0, 0, 0, 1];
  }
  const axis = k => [c[3 + k], c[6 + k], c[9 + k]];
  view = {eye: c.slice(0, 3), x: axis(0), y: axis(1), z: axis(2), zoom: 1};
  view.focus = medianDepth(view.eye, view.z);
  redraw();
}

function draw() {
  pending = false;
  const ratio = Math.min(2, devicePixelRatio || 1);
  canvas.width = Math.max(1, Math.round(canvas.clientWidth * ratio));
  canvas.height = Math.max(1, Math.round(canvas.clientHeight * ratio));
  const [w, h] = [canvas.width, canvas.height], {eye, x, y, z} = view;
  // The camera's picture fits into the window, whatever its shape.
  const [cw, ch, fx, fy, cx, cy] = page.camera || [640, 480, 525, 525, 319.5, 239.5];
  const k = Math.min(w / cw, h / ch);
  gl.viewport(0, 0, w, h);
  gl.clearColor(0, 0, 0, 1);
  gl.clear(gl.COLOR_BUFFER_BIT);
  sort(z, eye);
  gl.uniformMatrix3fv(uniform('R'), false, [0, 1, 2].flatMap(i => [x[i], y[i], z[i]]));
  gl.uniform3fv(uniform('eye'), eye);
  gl.uniform4f(uniform('lens'), k * fx, k * fy, k * (cx + 0.5 - cw / 2) + w / 2 - 0.5,
               k * (cy + 0.5 - ch / 2) + h / 2 - 0.5);
  gl.uniform2f(uniform('size'), w, h);
  gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, count);
  document.body.dataset.frames = ++frames;
}
const redraw = () => {
  if (!pending) requestAnimationFrame(draw);
  pending = true;
};

function orbit(yaw, pitch) {
  const target = add(view.eye, view.z, view.focus);
  for (const [axis, angle] of [[page.up, yaw], [view.x, pitch]])
    for (const name of ['x', 'y', 'z']) view[name] = turned(view[name], axis, angle);
  view.eye = add(target, view.z, -view.focus);
  redraw();
}
function zoom(factor) {
  const target = add(view.eye, view.z, view.focus);
  view.focus = Math.min(1e4, Math.max(0.05, view.focus * factor));
  view.eye = add(target, view.z, -view.focus);
  redraw();
}
function pan(dx, dy) {
  const s = view.focus / canvas.clientHeight;
  view.eye = add(add(view.eye, view.x, -s * dx), view.y, -s * dy);
  redraw();
}
const touches = new Map();
canvas.addEventListener('pointerdown', e => {
  canvas.setPointerCapture(e.pointerId);
  touches.set(e.pointerId, e);
});
for (const name of ['pointerup', 'pointercancel'])
  canvas.addEventListener(name, e => touches.delete(e.pointerId));
canvas.addEventListener('pointermove', e => {
  const before = touches.get(e.pointerId);
  if (!before) return;
  const dx = e.clientX - before.clientX, dy = e.clientY - before.clientY;
  if (touches.size === 2) {  // pinch
    const other = [...touches.values()].find(t => t.pointerId !== e.pointerId);
    const length = t => Math.hypot(t.clientX - other.clientX, t.clientY - other.clientY);
    zoom(length(before) / Math.max(1, length(e)));
    pan(dx / 2, dy / 2);
  } else if (e.buttons > 1 || e.shiftKey) {
    pan(dx, dy);
  } else {
    orbit(-0.006 * dx, 0.006 * dy);
  }
  touches.set(e.pointerId, e);
});
canvas.addEventListener('contextmenu', e => e.preventDefault());
canvas.addEventListener('wheel', e => {
  e.preventDefault();
  zoom(Math.exp(0.0015 * e.deltaY));
}, {passive: false});
addEventListener('keydown', e => {
  const act = {ArrowLeft: () => orbit(0.08, 0), ArrowRight: () => orbit(-0.08, 0),
    ArrowUp: () => orbit(0, -0.08), ArrowDown: () => orbit(0, 0.08), '+': () => zoom(1 / 1.15),
    '-': () => zoom(1.15), n: () => openView(current + 1), p: () => openView(current - 1),
    h: () => document.body.classList.toggle('bare')}[e.key];
  if (act && !e.ctrlKey && !e.metaKey) act();
});
byId('next').addEventListener('click', () => openView(current + 1));
byId('previous').addEventListener('click', () => openView(current - 1));
document.body.classList.toggle('bare', location.hash.includes('bare'));
new ResizeObserver(() => view && redraw()).observe(canvas);
openView(Number((location.hash.match(/view=(\d+)/) || [0, 0])[1]));
