// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import {
  contrast,
  hold,
  openPage,
  pngContrast,
  screenshot,
  startBrowser,
  startRun,
  temporaryFolder,
  until,
} from "./harness.mjs";
import { turningCamera } from "./turning_camera.mjs";

const kRoom = ["synth:room:clean"];
const kBlank = 4; // grey-value deviation that an empty view stays below

let browser;
before(async () => (browser = await startBrowser()));
after(() => browser.close());

async function turnView(page) {
  await page.mouse.move(300, 200);
  await page.mouse.down();
  await page.mouse.move(380, 230, { steps: 4 });
  await page.mouse.up();
}

test("the map grows in the page and is the session's", async (t) => {
  const run = await startRun(t, [...kRoom, "--frames", "0:40"]);
  const { step, resume } = await hold(t, run);
  // Points: software WebGL takes seconds for splats where the machine is busy.
  const { page, whenever, complaints } = await openPage(t, browser, `${run.url}?mode=points`);
  step();
  const early = await whenever("a first map arrives", (s) => s.gaussians_held > 0);
  assert.equal(early.mode, "points");
  resume();
  await whenever("the map grows", (s) => s.gaussians_held > early.gaussians_held);
  const end = await whenever(
    "the whole map arrives",
    (s) => s.finished && s.held_version === s.map_version,
  );
  assert.equal(end.frame, 39);
  assert.equal(end.gaussians_held, end.gaussians);
  await until("metrics are shown", () => page.locator("#metrics").isVisible());
  assert.deepEqual(complaints, []);
});

test("a camera that turns to the floor switches the degeneracy panel", async (t) => {
  const folder = temporaryFolder();
  const trajectory = join(folder, "turn.txt");
  writeFileSync(trajectory, turningCamera(70));
  const run = await startRun(t, ["synth:room", "--trajectory", trajectory, "--frames", "0:70"], {
    folder,
  });
  // The run is over before a slow browser has opened the page.
  const { step, resume } = await hold(t, run);
  const { page, whenever, complaints } = await openPage(t, browser, run.url);
  step();
  const arrows = () => page.locator("#camera-icon .axis.unseen").count();
  const sentence = () => page.locator("#status-sentence").textContent();
  await whenever(
    "all axes are seen",
    (s) => s.status_text === "all six axes are seen by geometry" && s.mask === 0,
  );
  assert.equal(await arrows(), 0);
  resume();
  const plane = await whenever("the floor shows", (s) => s.mask === 7);
  assert.equal(
    plane.status_text,
    "sliding along x and y and turning about z are unobservable: vision fills them",
  );
  await until("three arrows turn hollow", async () => (await arrows()) === 3);
  await until(
    "three rows say so",
    async () => (await page.locator("#axis-rows tr.unseen").count()) === 3,
  );
  assert.match(await sentence(), /vision fills/);
  assert.deepEqual(complaints, []);
});

test("pictures by the viewer follow the view and are not blank", async (t) => {
  const { url } = await startRun(t, [...kRoom, "--frames", "0:40"]);
  const { page, state, whenever, complaints } = await openPage(t, browser, url);
  // Software WebGL is detected: nobody asked for pictures.
  const first = await whenever("a picture is shown", (s) => s.picture > 0);
  assert.equal(first.mode, "picture");
  assert.equal(first.webgl, "software");
  await whenever("the run ends", (s) => s.finished);
  await page.getByRole("radio", { name: "Points" }).click();
  await whenever("points are shown", (s) => s.mode === "points" && s.picture === 0);
  await page.getByRole("radio", { name: "Picture" }).click();
  await whenever("a picture is shown again", (s) => s.picture > 0);
  await until("the picture is not blank", async () => (await contrast(page, "picture")) > kBlank);
  const { picture } = await state();
  await turnView(page);
  await whenever("turning the view brings another", (s) => s.picture > picture);
  assert.deepEqual(complaints, []);
});

test("each display mode shows the map, and the screenshot is what is shown", async (t) => {
  const { url } = await startRun(t, [...kRoom, "--frames", "0:30"]);
  const { page, whenever, complaints } = await openPage(t, browser, `${url}?camera=first`);
  await whenever("the run ends", (s) => s.finished);
  for (const [name, mode] of [
    ["Splats", "splats"],
    ["Points", "points"],
    ["Picture", "picture"],
  ]) {
    await page.getByRole("radio", { name }).click();
    await whenever(`${mode} are chosen`, (s) => s.mode === mode);
    await until(
      `${mode} are not blank`,
      async () => (await pngContrast(page, await screenshot(page))) > kBlank,
    );
  }
  assert.deepEqual(complaints, []);
});

test("images of the frame are shown, and not sent when folded away", async (t) => {
  const run = await startRun(t, [...kRoom, "--frames", "0:40"]);
  const { step, resume } = await hold(t, run);
  const { page, whenever, complaints } = await openPage(t, browser, run.url);
  step();
  for (const pane of ["color", "depth", "render", "error"]) {
    await until(`${pane} is shown`, () => page.locator(`figure.filled #pane-${pane}`).isVisible());
  }
  assert.ok((await contrast(page, "pane-color")) > kBlank);
  await page.keyboard.press("i");
  assert.ok(!(await page.locator("#panes").isVisible()));
  resume();
  await whenever("the run goes on", (s) => s.finished);
  assert.deepEqual(complaints, []);
});

test("pause, step, resume", async (t) => {
  const run = await startRun(t, [...kRoom, "--frames", "0:240"]);
  const { resume } = await hold(t, run);
  const { page, whenever } = await openPage(t, browser, run.url);
  // Three pictures: time enough for many a frame, were the run not held.
  const watch = async () => {
    for (let i = 0; i < 3; ++i) {
      const { picture } = await whenever("a picture is shown", (s) => s.picture > 0);
      await turnView(page);
      await whenever("turning the view brings another", (s) => s.picture > picture);
    }
  };
  await whenever("the page sees the pause", (s) => s.paused);
  resume();
  await whenever("frames come", (s) => s.frame > 3 && !s.paused);
  await page.keyboard.press(" ");
  const { frame } = await whenever("it pauses", (s) => s.paused);
  await watch();
  // The one that was under way when the pause came, and the one of the step.
  await page.locator("#step").click();
  const stepped = await whenever("one frame is done", (s) => s.frame > frame);
  await watch();
  const still = await whenever("it stays paused", (s) => s.paused);
  assert.ok(
    stepped.frame <= frame + 2 && still.frame <= frame + 2,
    `${frame}, ${stepped.frame}, ${still.frame}`,
  );
  await page.locator("#pause").click();
  const end = await whenever("it goes on to the end", (s) => s.finished);
  assert.equal(end.frame, 239);
});

test("a reload and another viewer at the same address are survived", async (t) => {
  const first = await startRun(t, [...kRoom, "--frames", "0:50"]);
  const { page, whenever, complaints } = await openPage(t, browser, first.url);
  await page.getByRole("radio", { name: "Points" }).click();
  await whenever(
    "the run ends",
    (s) => s.finished && s.held_version === s.map_version && s.gaussians_held > 0,
  );
  await page.reload();
  const again = await whenever(
    "the whole map is there again",
    (s) => s.finished && s.gaussians_held === s.gaussians,
  );
  assert.equal(again.mode, "points", "the chosen mode is kept");
  assert.deepEqual(complaints, []);

  await first.stop();
  await whenever("the loss is noticed", (s) => !s.connected);
  await until("it is said", () => page.locator("#notice").isVisible());
  await startRun(t, [...kRoom, "--frames", "0:20"], { port: first.port });
  const back = await whenever(
    "the other run is shown",
    (s) => s.connected && s.finished && s.frame === 19,
  );
  assert.ok(back.gaussians > 0);
  await whenever("its map replaces the old one", (s) => s.gaussians_held === s.gaussians);
  await until("the notice goes away", async () => !(await page.locator("#notice").isVisible()));
});

test("a phone shows everything, one below the other", async (t) => {
  const { url } = await startRun(t, [...kRoom, "--frames", "0:30"]);
  const { page, whenever, complaints } = await openPage(t, browser, url, {
    viewport: { width: 390, height: 844 },
    hasTouch: true,
    isMobile: true,
  });
  await whenever("a picture is shown", (s) => s.picture > 0);
  const width = await page.evaluate(() => document.documentElement.scrollWidth);
  assert.equal(width, 390, "nothing sticks out");
  for (const id of ["stage", "status-sentence", "camera-icon", "condition-chart", "panes"]) {
    const box = await page.locator(`#${id}`).boundingBox();
    assert.ok(box && box.width > 300 && box.height > 40, `${id} is ${JSON.stringify(box)}`);
  }
  const [panel, stage] = [
    await page.locator("#panel").boundingBox(),
    await page.locator("#stage").boundingBox(),
  ];
  assert.ok(panel.y > stage.y + stage.height);
  await whenever("the run ends", (s) => s.finished);
  assert.deepEqual(complaints, []);
});

test("the help overlay lists the keys", async (t) => {
  const { url } = await startRun(t, [...kRoom, "--frames", "0:5"]);
  const { page, complaints } = await openPage(t, browser, url);
  await page.keyboard.press("?");
  assert.ok(await page.getByRole("dialog").isVisible());
  assert.ok((await page.locator("#shortcuts tr").count()) > 10);
  await page.keyboard.press("Escape");
  assert.ok(!(await page.getByRole("dialog").isVisible()));
  assert.deepEqual(complaints, []);
});
