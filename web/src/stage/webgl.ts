// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0

export type WebGlKind = "hardware" | "software" | "none";

const kSoftware = /swiftshader|llvmpipe|softpipe|software|basic render/i;

/// True for the names that software rasterizers go by.
export function isSoftwareRenderer(name: string): boolean {
  return kSoftware.test(name);
}

/// Whether WebGL 2 is there, and whether a graphics processor stands behind it.
export function detectWebGl(): WebGlKind {
  const canvas = document.createElement("canvas");
  const gl = canvas.getContext("webgl2");
  if (!gl) return "none";
  const info = gl.getExtension("WEBGL_debug_renderer_info");
  const name: unknown = gl.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : gl.RENDERER);
  gl.getExtension("WEBGL_lose_context")?.loseContext();
  return isSoftwareRenderer(String(name)) ? "software" : "hardware";
}
