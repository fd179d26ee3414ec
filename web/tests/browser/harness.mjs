// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after } from "node:test";
import { chromium } from "playwright-core";
import WebSocket from "ws";

const kFlags = [
  "--no-sandbox",
  "--use-angle=swiftshader",
  "--enable-unsafe-swiftshader",
  "--ignore-gpu-blocklist",
  "--disable-background-networking",
  "--disable-component-update",
  "--disable-sync",
  "--no-first-run",
];
/// The one limit: a broken page fails after it; a busy machine never reaches it.
const kPatience_ms = 240_000;

/// Waits until `condition` gives something true; fails with `what` otherwise.
export async function until(what, condition) {
  const end = performance.now() + kPatience_ms;
  for (;;) {
    const value = await condition();
    if (value) return value;
    assert.ok(performance.now() < end, `in ${kPatience_ms} ms it did not happen that ${what}`);
    await new Promise((resolve) => setTimeout(resolve, 50));
  }
}

const folders = [];
after(() => folders.forEach((folder) => rmSync(folder, { recursive: true, force: true })));

/// A folder that is gone after all tests: then nobody writes into it any more.
export function temporaryFolder() {
  folders.push(mkdtempSync(join(tmpdir(), "sgs-browser-")));
  return folders.at(-1);
}

/// `sgs run ... --viewer PORT`, stopped after the test. Resolves when the address is printed.
export async function startRun(t, args, { port = 0, folder = temporaryFolder() } = {}) {
  const common = [
    "--viewer",
    String(port),
    "--viewer-stay",
    "--no-eval",
    "--output",
    join(folder, `run-${Date.now()}`),
  ];
  const child = spawn(process.env.SGS, ["run", ...args, ...common], {
    cwd: folder, // where `runs/latest` is then written
    stdio: ["ignore", "ignore", "pipe"],
  });
  let printed = "";
  child.stderr.on("data", (data) => (printed += data));
  const ended = new Promise((resolve) => child.on("exit", resolve));
  const stop = async () => {
    child.kill("SIGINT");
    const timer = setTimeout(() => child.kill("SIGKILL"), 10_000);
    await ended;
    clearTimeout(timer);
  };
  t.after(stop);
  const url = await until(`sgs prints an address (so far: ${printed})`, () => {
    assert.equal(child.exitCode, null, `sgs ended: ${printed}`);
    return printed.match(/http:\/\/127\.0\.0\.1:\d+\//)?.[0];
  });
  return { url, port: Number(new URL(url).port), stop };
}

/// `sgs run live:...` at the rate of a `Camera` (fake_camera.mjs) that somebody holds, stopped after the
/// test. Resolves when the page's address is printed.
export async function startLiveRun(t, Camera, { folder = temporaryFolder() }) {
  const output = join(folder, "session");
  const args = ["run", "live:tcp://127.0.0.1:0", "--realtime", "--viewer", "0", "--no-eval"];
  const child = spawn(process.env.SGS, [...args, "--output", output], {
    cwd: folder,
    stdio: ["ignore", "ignore", "pipe"],
  });
  let printed = "";
  child.stderr.on("data", (data) => (printed += data));
  const ended = new Promise((resolve) => child.on("exit", resolve));
  t.after(async () => {
    child.kill("SIGINT");
    const timer = setTimeout(() => child.kill("SIGKILL"), 10_000);
    await ended;
    clearTimeout(timer);
  });
  const ports = () => [...printed.matchAll(/tcp:\/\/127\.0\.0\.1:(\d+)[^\n]*waiting/g)];
  const alive = () => assert.equal(child.exitCode, null, `sgs ended: ${printed}`);
  const port = await until("sgs listens", () => alive() ?? ports()[0]?.[1]);
  const camera = new Camera(t, Number(port));
  const url = await until(
    `sgs prints an address (so far: ${printed})`,
    () => alive() ?? printed.match(/http:\/\/127\.0\.0\.1:\d+\//)?.[0],
  );
  const listens = () => {
    camera.port = Number(ports().at(-1)[1]);
    return ports().length;
  };
  return {
    url,
    port: Number(new URL(url).port),
    camera,
    folder: output,
    printed: () => printed,
    listens,
  };
}

/// A viewer without a page: the newest `state` and `session`, and what it asks for.
export async function watch(t, { port }) {
  const socket = new WebSocket(`ws://127.0.0.1:${port}/ws`);
  t.after(() => socket.terminate());
  const seen = {
    state: null,
    session: null,
    closed: false,
    ask: (action) => socket.send(JSON.stringify({ type: "control", action })),
  };
  socket.on("message", (data, binary) => {
    const message = binary ? {} : JSON.parse(data);
    if (message.type === "state") seen.state = message;
    if (message.type === "session") seen.session = message;
  });
  socket.on("close", () => (seen.closed = true));
  await new Promise((resolve, reject) => {
    socket.on("open", resolve);
    socket.on("error", reject);
  });
  return seen;
}

/// A second viewer of the run, without a page, that pauses it at once and until `resume()`: the page
/// is then there from (nearly) the first frame on, however long the browser takes. `step()` lets one
/// frame pass.
export async function hold(t, { port }) {
  const socket = new WebSocket(`ws://127.0.0.1:${port}/ws`);
  t.after(() => socket.terminate());
  const paused = new Promise((resolve, reject) => {
    socket.on("error", reject);
    socket.on("message", (data, binary) => {
      if (!binary && JSON.parse(data).paused) resolve();
    });
  });
  const ask = (action) => socket.send(JSON.stringify({ type: "control", action }));
  // A step, not a pause: before the first frame there is no state to tell of it.
  socket.on("open", () => ask("step"));
  await paused;
  return { step: () => ask("step"), resume: () => ask("resume") };
}

/// Headless Chromium, to be closed by the caller.
export function startBrowser() {
  return chromium.launch({
    executablePath: process.env.SGS_CHROMIUM,
    args: kFlags,
    timeout: kPatience_ms,
  });
}

/// The page of a viewer. `complaints` collects console errors, exceptions and requests to elsewhere.
export async function openPage(t, browser, url, options = {}) {
  // Small, because the processor draws it, but wide enough for the panel beside the map.
  const page = await browser.newPage({ viewport: { width: 900, height: 560 }, ...options });
  t.after(() => page.close());
  page.setDefaultTimeout(kPatience_ms);
  const complaints = [];
  const own = new URL(url).host;
  page.on("console", (message) => {
    if (message.type() === "error") complaints.push(`console: ${message.text()}`);
  });
  page.on("pageerror", (error) => complaints.push(`exception: ${error.stack}`));
  page.on("request", (request) => {
    const { protocol, host } = new URL(request.url());
    if (!["data:", "blob:"].includes(protocol) && host !== own)
      complaints.push(`outside: ${request.url()}`);
  });
  await page.goto(url);
  const state = () => page.evaluate(() => window.sgs_state);
  const whenever = (what, condition) =>
    until(what, async () => {
      const now = await state();
      return now && condition(now) ? now : null;
    });
  return { page, state, whenever, complaints };
}

/// Standard deviation of the grey values (0..255) of a canvas on the page.
export function contrast(page, id) {
  return page.evaluate((name) => {
    const source = document.getElementById(name);
    const copy = document.createElement("canvas");
    [copy.width, copy.height] = [160, 100];
    const context = copy.getContext("2d");
    context.drawImage(source, 0, 0, 160, 100);
    const { data } = context.getImageData(0, 0, 160, 100);
    let [sum, squares] = [0, 0];
    for (let i = 0; i < data.length; i += 4) {
      const grey = (data[i] + data[i + 1] + data[i + 2]) / 3;
      sum += grey;
      squares += grey * grey;
    }
    const n = data.length / 4;
    return Math.sqrt(Math.max(0, squares / n - (sum / n) ** 2));
  }, id);
}

/// The PNG that the page's screenshot button offers as a download, in base64. It is taken where the
/// page hands it over: what Chromium does with downloads is not the page's, and does not always end.
export function screenshot(page) {
  return page.evaluate(
    () =>
      new Promise((resolve, reject) => {
        const offer = URL.createObjectURL;
        URL.createObjectURL = (blob) => {
          if (blob.type !== "image/png") return offer.call(URL, blob); // the script of a worker
          URL.createObjectURL = offer;
          const reader = new FileReader();
          reader.onload = () => resolve(reader.result.split(",")[1]);
          reader.onerror = () => reject(reader.error);
          reader.readAsDataURL(blob);
          return "#";
        };
        HTMLAnchorElement.prototype.click = function () {
          delete HTMLAnchorElement.prototype.click;
          if (!this.download.endsWith(".png")) reject(new Error(`saved as "${this.download}"`));
        };
        document.getElementById("screenshot").click();
      }),
  );
}

/// Grey-value deviation of a PNG, decoded by the browser.
export function pngContrast(page, png_base64) {
  return page.evaluate(async (base64) => {
    const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
    const bitmap = await createImageBitmap(new Blob([bytes], { type: "image/png" }));
    const canvas = new OffscreenCanvas(160, 100);
    const context = canvas.getContext("2d");
    context.drawImage(bitmap, 0, 0, 160, 100);
    const { data } = context.getImageData(0, 0, 160, 100);
    const greys = Array.from(
      { length: data.length / 4 },
      (_, i) => (data[4 * i] + data[4 * i + 1] + data[4 * i + 2]) / 3,
    );
    const mean = greys.reduce((a, b) => a + b) / greys.length;
    return Math.sqrt(greys.reduce((a, g) => a + (g - mean) ** 2, 0) / greys.length);
  }, png_base64);
}
