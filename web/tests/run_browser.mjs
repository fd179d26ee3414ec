// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// node tests/run_browser.mjs SGS: runs tests/browser/*.test.mjs against that executable and headless
// Chromium ($SGS_CHROMIUM, /usr/bin/chromium). Exit code 77 = skipped.
import { spawnSync } from "node:child_process";
import { existsSync, readdirSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

function skip(reason) {
  const kSkipped = 77;
  console.log(`skipped: ${reason}`);
  process.exit(kSkipped);
}

const chromium = process.env.SGS_CHROMIUM ?? "/usr/bin/chromium";
const sgs = process.argv[2];
const here = dirname(fileURLToPath(import.meta.url));
if (!existsSync(chromium)) skip(`no ${chromium} (Debian package chromium; or set SGS_CHROMIUM)`);
if (!existsSync(join(here, "../node_modules"))) skip("the page's packages are not installed");
const help = spawnSync(sgs, ["run", "--help"], { encoding: "utf8" }).stdout;
if (!help.includes("--viewer")) skip(`${sgs} is built without the viewer`);

const folder = join(here, "browser");
const tests = readdirSync(folder).filter((name) => name.endsWith(".test.mjs"));
const { status } = spawnSync(
  process.execPath,
  ["--test", ...tests.map((name) => join(folder, name))],
  {
    stdio: "inherit",
    env: { ...process.env, SGS: sgs, SGS_CHROMIUM: chromium },
  },
);
process.exit(status ?? 1);
