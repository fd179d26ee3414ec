// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// node tests/run_browser.mjs SGS: runs tests/browser/*.test.mjs against that executable and headless
// Chromium ($SGS_CHROMIUM, /usr/bin/chromium). Exit code 77 = skipped, there is no Chromium.
import { spawnSync } from "node:child_process";
import { existsSync, readdirSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const kSkipped = 77;
const chromium = process.env.SGS_CHROMIUM ?? "/usr/bin/chromium";
const sgs = process.argv[2];
if (!existsSync(chromium)) {
  console.log(`skipped: no ${chromium} (Debian package chromium; or set SGS_CHROMIUM)`);
  process.exit(kSkipped);
}
const help = spawnSync(sgs, ["run", "--help"], { encoding: "utf8" }).stdout;
if (!help.includes("--viewer")) {
  console.log(`skipped: ${sgs} is built without the viewer`);
  process.exit(kSkipped);
}

const folder = join(dirname(fileURLToPath(import.meta.url)), "browser");
const tests = readdirSync(folder).filter((name) => name.endsWith(".test.mjs"));
const { status } = spawnSync(process.execPath, ["--test", ...tests.map((name) => join(folder, name))], {
  stdio: "inherit",
  env: { ...process.env, SGS: sgs, SGS_CHROMIUM: chromium },
});
process.exit(status ?? 1);
