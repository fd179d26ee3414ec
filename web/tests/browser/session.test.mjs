// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// A session as people have one: a camera in the hand, the page on another machine.
import assert from "node:assert/strict";
import { existsSync, readFileSync, readdirSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { FakeCamera } from "./fake_camera.mjs";
import { openPage, startBrowser, startLiveRun, temporaryFolder, until, watch } from "./harness.mjs";

let browser;
before(async () => (browser = await startBrowser()));
after(() => browser.close());

const press = (page, id) => page.locator(`#${id}`).click();
const stateOf = (folder) => readFileSync(join(folder, "state.toml"), "utf8");

/// What a link on the page gives.
function download(page, name) {
  return page.evaluate(async (wanted) => {
    const link = [...document.querySelectorAll("#downloads a")].find((a) => a.download === wanted);
    const answer = await fetch(link.href);
    const bytes = new Uint8Array(await answer.arrayBuffer());
    return {
      disposition: answer.headers.get("content-disposition"),
      bytes: bytes.length,
      begins: new TextDecoder().decode(bytes.slice(0, 400)),
    };
  }, name);
}

test("a whole session: start, record, warn, pause, go on, save, finish, refine, download", async (t) => {
  const folder = temporaryFolder();
  const run = await startLiveRun(t, FakeCamera, { folder });
  const { page, state, whenever, complaints } = await openPage(
    t,
    browser,
    `${run.url}?mode=points`,
  );
  await whenever("frames are tracked", (s) => s.frame > 5 && s.gaussians > 0);
  const session = (what, condition) => whenever(what, (s) => s.session && condition(s.session, s));
  await session("the camera's rate is told", (n) => n.camera_fps > 0);
  assert.ok(await page.locator("#session").isVisible());

  await t.test("record", async () => {
    assert.ok(await page.locator("#finish-refine").isDisabled(), "nothing is kept yet");
    await press(page, "record");
    await session("it is recorded", (n) => n.recording && n.refinable);
    assert.ok(await page.locator("#finish-refine").isEnabled());
  });

  await t.test("warn", async () => {
    run.camera.light = false;
    await session("the dark is told", (n) => n.warnings.some(({ key }) => key === "dark"));
    await until("the page shows it", () => page.locator("#warnings li[data-key=dark]").isVisible());
    assert.match(await page.locator("#warnings").textContent(), /It is dark/);
    run.camera.light = true;
    await session("it is over", (n) => n.warnings.length === 0);
    run.camera.surface = false;
    await session("that nothing is seen is told", (n) =>
      n.warnings.some(({ key }) => key === "nothing_seen"),
    );
    run.camera.surface = true;
    await session("that is over, too", (n) => n.warnings.length === 0);
    await until("the page is calm", async () => !(await page.locator("#warnings").isVisible()));
  });

  await t.test("pause and go on", async () => {
    await page.keyboard.press(" ");
    const { frame } = await whenever("it pauses", (s) => s.paused);
    const { sent } = run.camera;
    await until("the camera goes on", () => run.camera.sent > sent + 20);
    await session("frames are left out", (n) => n.left_out > 5);
    assert.ok((await state()).frame <= frame + 1, "none of them is tracked");
    await press(page, "pause");
    await whenever("it goes on", (s) => !s.paused && s.frame > frame + 20);
    await whenever("it is tracked again", (s) => !/lost/.test(s.status_text));
    await until("the page tells what was left out", async () =>
      /left out while paused/.test(await page.locator("#camera-line").textContent()),
    );
  });

  await t.test("save", async () => {
    await press(page, "save");
    await session("it is saved", (n) => /^saved/.test(n.saved) && n.downloads.includes("map.ply"));
    const map = await download(page, "map.ply");
    assert.match(map.begins, /^ply\n/);
    assert.equal(map.disposition, 'attachment; filename="map.ply"');
    assert.ok(!(await state()).finished, "the run goes on");
  });

  await t.test("finish and refine", async () => {
    await press(page, "finish-refine");
    await session("the run ends properly", (n) => n.ended);
    assert.match(stateOf(run.folder), /state = "finished"/);
    await until("it is refined", async () =>
      /dB/.test(await page.locator("#refinement").textContent()),
    );
    assert.equal(await page.locator("#finish-refine-label").textContent(), "Enough");
    await press(page, "finish-refine");
    await until("it ends with the best so far", async () =>
      /before/.test(await page.locator("#refinement").textContent()),
    );
    assert.ok(existsSync(join(`${run.folder}-refined`, "map.ply")));
    await until("metrics are shown", () => page.locator("#metrics").isVisible());
  });

  await t.test("download", async () => {
    const map = await download(page, "map.ply");
    const file = readFileSync(join(`${run.folder}-refined`, "map.ply"));
    assert.equal(map.bytes, file.length);
    assert.match((await download(page, "trajectory.txt")).begins, /^100\.0+ 0\.0+ /);
    assert.ok(readdirSync(join(run.folder, "recording/rgb")).length > 20);
  });
  assert.deepEqual(complaints, []);
});

test("a run that is started again is another one, in a folder of its own", async (t) => {
  const folder = temporaryFolder();
  const run = await startLiveRun(t, FakeCamera, { folder });
  const { page, whenever } = await openPage(t, browser, `${run.url}?mode=points`);
  await whenever("frames are tracked", (s) => s.frame > 30);
  await press(page, "again");
  await until("it says so", () => /starts again/.test(run.printed()));
  await until("it listens again", () => run.listens() === 2);
  run.camera.connect();
  await whenever("the page sees the new run", (s) => s.connected && s.frame >= 0 && s.frame < 30);
  await until("the new run is there", () => existsSync(join(`${run.folder}-2`, "state.toml")));
  assert.match(stateOf(run.folder), /state = "finished"/);
});

test("clients that want different things, and the same twice", async (t) => {
  const run = await startLiveRun(t, FakeCamera, {});
  const [one, other] = [await watch(t, run), await watch(t, run)];
  await until("frames are tracked", () => one.state?.frame > 3);
  one.ask("pause");
  other.ask("pause");
  await until("it pauses", () => one.state.paused && other.state.paused);
  other.ask("record");
  one.ask("record");
  await until("it is recorded", () => one.session?.recording);
  other.ask("stop_recording");
  await until("it is recorded no more", () => one.session?.recording === false);
  one.ask("save");
  other.ask("save");
  await until("it is saved while it is paused", () => /^saved/.test(other.session?.saved));
  one.ask("finish");
  one.ask("finish");
  other.ask("resume");
  await until("it ends although it was paused", () => other.session?.ended);
  one.ask("pause");
  one.ask("record");
  one.ask("save");
  await until("both know", () => one.session.ended && one.state.finished);
  assert.match(stateOf(run.folder), /state = "finished"/);
  // What no server of this kind knows ends that client alone.
  other.ask("explode");
  await until("it is sent away", () => other.closed);
  assert.ok(!one.closed);
});
