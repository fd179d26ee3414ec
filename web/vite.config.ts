// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
import { existsSync, readFileSync } from "node:fs";
import { fileURLToPath } from "node:url";
import { defineConfig, type Plugin } from "vite";

const bundled = ["three", "@sparkjsdev/spark", "uplot", "fflate"];

/// Puts the licences of what is bundled beside the bundle, as they ask for.
function licences(): Plugin {
  return {
    name: "licences",
    generateBundle() {
      const texts = bundled.map((name) => {
        const file = fileURLToPath(new URL(`node_modules/${name}/LICENSE`, import.meta.url));
        if (!existsSync(file)) throw new Error(`${file} is missing`);
        return `${name}\n\n${readFileSync(file, "utf8").trim()}\n`;
      });
      const source = texts.join(`\n${"-".repeat(72)}\n\n`);
      this.emitFile({ type: "asset", fileName: "assets/licences.txt", source });
    },
  };
}

// `npm run dev` serves the page from its sources; data come from a viewer or from `npm run mock`.
const backend = process.env["SGS_VIEWER"] ?? "127.0.0.1:8091";

export default defineConfig({
  base: "./",
  plugins: [licences()],
  server: {
    proxy: {
      // The viewer talks only to its own page: the proxy speaks in its name.
      "/ws": {
        target: `http://${backend}`,
        ws: true,
        changeOrigin: true,
        headers: { Origin: `http://${backend}` },
      },
    },
  },
  build: {
    target: "es2022",
    assetsInlineLimit: 0,
    modulePreload: false,
    chunkSizeWarningLimit: 5000,
    rollupOptions: { output: { entryFileNames: "assets/[name]-[hash].js" } },
  },
});
