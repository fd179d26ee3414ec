// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// node tests/run_unit.mjs: checks the types of the whole page, then runs tests/unit/*.test.ts.
// Exit code 77 = skipped.
import { spawnSync } from "node:child_process";
import { existsSync, mkdtempSync, readdirSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { fileURLToPath } from "node:url";

const kSkipped = 77;
const root = fileURLToPath(new URL("..", import.meta.url));
if (!existsSync(join(root, "node_modules"))) {
  console.log("skipped: the page's packages are not installed");
  process.exit(kSkipped);
}
const { build } = await import("esbuild");

function run(...args) {
  const { status } = spawnSync(process.execPath, args, { cwd: root, stdio: "inherit" });
  if (status !== 0) process.exit(1);
}

run("node_modules/typescript/bin/tsc", "--noEmit");
const out = mkdtempSync(join(tmpdir(), "sgs-web-"));
try {
  const names = readdirSync(join(root, "tests/unit")).filter((name) => name.endsWith(".test.ts"));
  await build({
    absWorkingDir: root,
    entryPoints: names.map((name) => `tests/unit/${name}`),
    outdir: out,
    outExtension: { ".js": ".mjs" },
    bundle: true,
    platform: "node",
    format: "esm",
    logLevel: "warning",
  });
  run("--test", ...names.map((name) => join(out, name.replace(/\.ts$/, ".mjs"))));
} finally {
  rmSync(out, { recursive: true, force: true });
}
