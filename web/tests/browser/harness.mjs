// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { chromium } from "playwright-core";

const kFlags = [
  "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist",
  "--disable-background-networking", "--disable-component-update", "--disable-sync", "--no-first-run",
];
const kPatience_ms = 90_000;

export const pause = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

/// Waits until `condition` gives something true; fails with `what` otherwise.
export async function until(what, condition, patience_ms = kPatience_ms) {
  const end = performance.now() + patience_ms;
  for (;;) {
    const value = await condition();
    if (value) return value;
    assert.ok(performance.now() < end, `in ${patience_ms} ms it did not happen that ${what}`);
    await pause(50);
  }
}

/// What `promise` gives, or null where it takes longer.
export async function within(patience_ms, promise) {
  let timer;
  const late = new Promise((resolve) => (timer = setTimeout(resolve, patience_ms, null)));
  try {
    return await Promise.race([promise, late]);
  } finally {
    clearTimeout(timer);
  }
}

/// A folder that is gone after the test.
export function temporaryFolder(t) {
  const folder = mkdtempSync(join(tmpdir(), "sgs-browser-"));
  t.after(() => rmSync(folder, { recursive: true, force: true }));
  return folder;
}

/// `sgs run ... --viewer PORT`, stopped after the test. Resolves when the address is printed.
export async function startRun(t, args, { port = 0, folder = temporaryFolder(t) } = {}) {
  const common = ["--viewer", String(port), "--viewer-stay", "--no-eval", "--output", join(folder, `run-${Date.now()}`)];
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

/// Headless Chromium, closed after the test.
export async function startBrowser(t) {
  const browser = await chromium.launch({ executablePath: process.env.SGS_CHROMIUM, args: kFlags });
  t.after(() => browser.close());
  return browser;
}

/// The page of a viewer. `complaints` collects console errors, exceptions and requests to elsewhere.
export async function openPage(browser, url, options = {}) {
  const page = await browser.newPage({ viewport: { width: 1280, height: 800 }, ...options });
  page.setDefaultTimeout(2 * kPatience_ms);
  const complaints = [];
  const own = new URL(url).host;
  page.on("console", (message) => {
    if (message.type() === "error") complaints.push(`console: ${message.text()}`);
  });
  page.on("pageerror", (error) => complaints.push(`exception: ${error.stack}`));
  page.on("request", (request) => {
    const { protocol, host } = new URL(request.url());
    if (!["data:", "blob:"].includes(protocol) && host !== own) complaints.push(`outside: ${request.url()}`);
  });
  await page.goto(url);
  const state = () => page.evaluate(() => window.sgs_state);
  const whenever = (what, condition, patience_ms) =>
    until(what, async () => {
      const now = await state();
      return now && condition(now) ? now : null;
    }, patience_ms);
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

/// The PNG that the page's screenshot button downloads.
export async function screenshot(page) {
  const waiting = page.waitForEvent("download");
  await page.locator("#screenshot").click();
  const chunks = [];
  for await (const chunk of await (await waiting).createReadStream()) chunks.push(chunk);
  return Buffer.concat(chunks);
}

/// Grey-value deviation of a PNG, decoded by the browser.
export function pngContrast(page, png) {
  return page.evaluate(async (base64) => {
    const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
    const bitmap = await createImageBitmap(new Blob([bytes], { type: "image/png" }));
    const canvas = new OffscreenCanvas(160, 100);
    const context = canvas.getContext("2d");
    context.drawImage(bitmap, 0, 0, 160, 100);
    const { data } = context.getImageData(0, 0, 160, 100);
    const greys = Array.from({ length: data.length / 4 }, (_, i) => (data[4 * i] + data[4 * i + 1] + data[4 * i + 2]) / 3);
    const mean = greys.reduce((a, b) => a + b) / greys.length;
    return Math.sqrt(greys.reduce((a, g) => a + (g - mean) ** 2, 0) / greys.length);
  }, png.toString("base64"));
}
