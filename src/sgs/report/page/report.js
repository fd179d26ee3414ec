// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
'use strict';
for (const input of document.querySelectorAll('.slide input[type=range]'))
  input.addEventListener('input', () =>
    input.parentElement.style.setProperty('--x', input.value + '%'));

// One moment in time, shown in every plot over time and in the 3-D view.
const listeners = [];
const show = t => listeners.forEach(f => f(t));
for (const svg of document.querySelectorAll('svg.time')) {
  const [x0, x1, left, right, top, bottom] = svg.dataset.axis.split(' ').map(Number);
  const line = svg.appendChild(document.createElementNS(svg.namespaceURI, 'path'));
  line.setAttribute('class', 'cursor');
  listeners.push(t => {
    const u = left + (t - x0) / (x1 - x0) * (right - left);
    line.setAttribute('d', t === null || u < left || u > right ? '' : `M${u} ${top}V${bottom}`);
  });
  svg.addEventListener('pointermove', e => {
    const box = svg.getBoundingClientRect();
    const u = (e.clientX - box.left) / box.width * svg.viewBox.baseVal.width;
    show(Math.min(x1, Math.max(x0, x0 + (u - left) / (right - left) * (x1 - x0))));
  });
}

// 3-D view: the map, paths, key frames, on a 2-D canvas.
function makeScene(box) {
  const data = JSON.parse(box.querySelector('script').textContent);
  const canvas = box.querySelector('canvas'), ctx = canvas.getContext('2d');
  const away = cross(data.up, data.across), layer = document.createElement('canvas');
  const on = name => (box.querySelector(`[name=${name}]`) || {checked: true}).checked;
  const start = {yaw: lookingAlong() + 0.6, pitch: 0.65, zoom: 1, pan: [0, 0, 0]};
  let view = {...start}, moment = null, pending = false, held = false;

  const centre = [0, 1, 2].map(k => (data.low[k] + data.high[k]) / 2);
  const radius = Math.hypot(...[0, 1, 2].map(k => data.high[k] - data.low[k])) / 2 || 1;
  const surface = makeSurface(data.points, data.runs[0].path, radius);

  // The yaw that looks the way the cameras looked on the whole; 0 where they looked all around.
  function lookingAlong() {
    const ahead = mix(...data.keyframes.map(pose => [1, [pose[5], pose[8], pose[11]]]));
    const [x, y] = [dot(ahead, away), -dot(ahead, data.across)];
    return Math.hypot(x, y) < 0.3 * data.keyframes.length ? 0 : Math.atan2(y, x);
  }

  function camera(w, h) {
    const {yaw, pitch} = view, target = mix([1, centre], [1, view.pan]);
    const back = mix([Math.cos(pitch) * Math.cos(yaw), mix([-1, away])],
                     [Math.cos(pitch) * Math.sin(yaw), data.across], [Math.sin(pitch), data.up]);
    const right = unit(cross(data.up, back)), up = cross(back, right), focal = 1.15 * h;
    const eye = mix([1, target], [1.95 * radius / view.zoom, back]);
    return {w, h, eye, right, up, back, focal, scale: 1.95 * radius / view.zoom / focal, project(p) {
      const d = [p[0] - eye[0], p[1] - eye[1], p[2] - eye[2]], z = -dot(d, back);
      return z < 0.02 * radius ? null
        : [w / 2 + focal * dot(d, right) / z, h / 2 - focal * dot(d, up) / z, z];
    }};
  }

  // At the page's own resolution, also where the screen's is finer, and at half of it while the
  // pointer turns it: it is the slow part.
  function drawSurface(w, h) {
    const [lw, lh] = [canvas.clientWidth, canvas.clientHeight].map(v =>
      Math.max(1, Math.round(held ? v / 2 : v)));
    const shown = JSON.stringify([lw, lh, view]);
    if (layer.shown !== shown) {
      [layer.width, layer.height, layer.shown] = [lw, lh, shown];
      layer.getContext('2d').putImageData(surface.image(camera(lw, lh)), 0, 0);
    }
    ctx.drawImage(layer, 0, 0, w, h);
  }

  function polyline(cam, path, colours, width) {
    ctx.lineWidth = width;
    let last = null, colour = null;
    for (let i = 0; i < path.length; i += 3) {
      const p = cam.project(path.slice(i, i + 3));
      const next = typeof colours === 'string' ? colours : colours[i / 3];
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

  function frustum(cam, pose, size, colour, width) {
    const [x, y, z] = [0, 1, 2].map(k => [pose[3 + k], pose[6 + k], pose[9 + k]]);
    const at = pose.slice(0, 3);
    const corners = [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(([a, b]) =>
      mix([1, at], [0.8 * a * size, x], [0.6 * b * size, y], [1.2 * size, z]));
    for (const c of corners) polyline(cam, [...at, ...c], colour, width);
    polyline(cam, [...corners, corners[0]].flat(), colour, width);
  }

  function colours(run, paint) {
    const values = box.querySelector('select')?.value === 'unseen' ? run.unseen : run.error;
    const top = values === run.unseen ? 1 : data.error_max;
    if (data.runs.length > 1 || !values || !top) return paint('c' + run.color);
    const steps = [...Array(9)].map((_, k) => paint('h' + k)), none = paint('c5');
    return values.map(v => v === null ? none
      : steps[Math.min(8, Math.max(0, Math.floor(9 * v / top)))]);
  }

  function draw() {
    pending = false;
    const ratio = Math.min(2, devicePixelRatio || 1);
    const w = canvas.width = Math.round(canvas.clientWidth * ratio);
    const h = canvas.height = Math.round(canvas.clientHeight * ratio);
    if (!w || !h) return;
    const style = getComputedStyle(document.documentElement);
    const paint = name => style.getPropertyValue('--' + name).trim();
    const cam = camera(w, h);
    if (on('map') && surface.count) drawSurface(w, h);
    const size = 0.035 * radius;
    if (on('cameras'))
      for (const pose of data.keyframes) frustum(cam, pose, size, paint('soft'), ratio);
    if (on('truth')) {
      polyline(cam, data.truth, paint('card'), 8 * ratio);
      polyline(cam, data.truth, paint('c5'), 6 * ratio);
    }
    for (const run of data.runs) {
      if (!on('truth')) polyline(cam, run.path, paint('card'), 5 * ratio);
      polyline(cam, run.path, colours(run, paint), 2.6 * ratio);
    }
    if (moment !== null) for (const run of data.runs) mark(cam, run, paint, ratio);
  }

  function mark(cam, run, paint, ratio) {
    const p = cam.project(run.path.slice(3 * nearest(run), 3 * nearest(run) + 3));
    if (!p) return;
    ctx.beginPath();
    ctx.arc(p[0], p[1], 6 * ratio, 0, 7);
    ctx.fillStyle = paint('c' + run.color);
    ctx.fill();
    ctx.lineWidth = 2 * ratio;
    ctx.strokeStyle = paint('card');
    ctx.stroke();
  }

  function nearest(run) {
    const i = run.time.findIndex(t => t >= moment);
    return i < 0 ? run.time.length - 1 : i;
  }

  const redraw = () => {
    if (!pending) requestAnimationFrame(draw);
    pending = true;
  };
  const turn = (yaw, pitch) => {
    view.yaw += yaw;
    view.pitch = Math.min(1.57, Math.max(-1.57, view.pitch + pitch));
    redraw();
  };
  const zoom = factor => {
    view.zoom = Math.min(30, Math.max(0.3, view.zoom * factor));
    redraw();
  };
  canvas.addEventListener('pointerdown', e => {
    canvas.setPointerCapture(e.pointerId);
    canvas.focus({preventScroll: true});
    held = true;
  });
  for (const end of ['pointerup', 'pointercancel'])
    canvas.addEventListener(end, () => {
      held = false;
      redraw();
    });
  canvas.addEventListener('pointermove', e => {
    if (!e.buttons) return;
    if (e.buttons > 1 || e.shiftKey) {
      const cam = camera(canvas.width, canvas.height), k = cam.scale * Math.min(2, devicePixelRatio);
      view.pan = mix([1, view.pan], [-k * e.movementX, cam.right], [k * e.movementY, cam.up]);
      redraw();
    } else {
      turn(-0.008 * e.movementX, 0.008 * e.movementY);
    }
  });
  canvas.addEventListener('contextmenu', e => e.preventDefault());
  canvas.addEventListener('wheel', e => {
    if (document.activeElement !== canvas) return;
    e.preventDefault();
    zoom(Math.exp(-0.0015 * e.deltaY));
  }, {passive: false});
  canvas.addEventListener('keydown', e => {
    const act = {ArrowLeft: () => turn(0.1, 0), ArrowRight: () => turn(-0.1, 0),
      ArrowUp: () => turn(0, 0.1), ArrowDown: () => turn(0, -0.1), '+': () => zoom(1.15),
      '-': () => zoom(1 / 1.15), '0': () => { view = {...start}; redraw(); }}[e.key];
    if (act) {
      e.preventDefault();
      act();
    }
  });
  const views = {above: {yaw: 0, pitch: 1.57}, side: {yaw: 0, pitch: 0.02}, reset: start};
  for (const button of box.querySelectorAll('button'))
    button.addEventListener('click', () => {
      view = {...start, ...views[button.name]};
      redraw();
    });
  for (const input of box.querySelectorAll('input[type=checkbox],select'))
    input.addEventListener('change', redraw);

  const clock = box.querySelector('input[type=range]'), output = box.querySelector('output');
  clock?.addEventListener('input', () => show(Number(clock.value)));
  listeners.push(t => {
    moment = t;
    redraw();
    if (t === null || !clock) return;
    clock.value = t;
    const run = data.runs[0], i = nearest(run), error = run.error?.[i], unseen = run.unseen?.[i];
    output.textContent = `${t.toFixed(2)} s` + (data.runs.length > 1 ? '' :
      (error == null ? '' : ` · error ${error.toPrecision(2)} cm`) +
      (unseen == null ? '' : ` · unseen ${unseen.toFixed(2)}`));
  });
  matchMedia('(prefers-color-scheme:dark)').addEventListener('change', redraw);
  new ResizeObserver(redraw).observe(canvas);
}
document.querySelectorAll('.scene').forEach(makeScene);
