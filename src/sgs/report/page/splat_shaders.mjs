// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0

// Records (io/splat_file.h) lie in a texture, two texels each; a vertex attribute names the record to
// draw. The coefficients of spherical harmonics lie in another, one texel per degree: each adds to the
// colour its basis function of the direction from the eye, as render/view_color.cc does.

export const kVertex = `#version 300 es
precision highp float;
precision highp usampler2D;
uniform usampler2D records;
uniform usampler2D harmonics;
uniform int degree;       // of the harmonics, 0 = none
uniform mat3 R;           // camera from world
uniform vec3 eye;
uniform vec4 lens;        // fx fy cx cy in pixels
uniform vec2 size;        // of the picture in pixels
in vec2 corner;
in uint index;
out vec2 offset;
out vec4 color;
flat out vec3 conic;
float coefficient(int number) {
  uint width = uint(textureSize(harmonics, 0).x);
  uint at = uint(degree) * index + uint(number >> 4);
  uvec4 texel = texelFetch(harmonics, ivec2(at % width, at / width), 0);
  return float(texel[number >> 2 & 3] >> (8 * (number & 3)) & 255u) / 128.0 - 1.0;
}
vec3 seenFrom(vec3 d) {
  float x = d.x, y = d.y, z = d.z, xx = x * x, yy = y * y, zz = z * z;
  float basis[15] = float[15](
    -0.4886025119 * y, 0.4886025119 * z, -0.4886025119 * x,
    1.0925484306 * x * y, -1.0925484306 * y * z, 0.3153915653 * (2.0 * zz - xx - yy),
    -1.0925484306 * x * z, 0.5462742153 * (xx - yy),
    -0.5900435899 * y * (3.0 * xx - yy), 2.8906114426 * x * y * z,
    -0.4570457995 * y * (4.0 * zz - xx - yy), 0.3731763326 * z * (2.0 * zz - 3.0 * xx - 3.0 * yy),
    -0.4570457995 * x * (4.0 * zz - xx - yy), 1.4453057213 * z * (xx - yy),
    -0.5900435899 * x * (xx - 3.0 * yy));
  vec3 sum = vec3(0.0);
  int functions = (degree + 1) * (degree + 1) - 1;
  for (int k = 0; k < functions; ++k) {
    sum += basis[k] * vec3(coefficient(3 * k), coefficient(3 * k + 1), coefficient(3 * k + 2));
  }
  return sum;
}
void main() {
  gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
  uint width = uint(textureSize(records, 0).x), at = 2u * index;
  uvec4 a = texelFetch(records, ivec2(at % width, at / width), 0);
  ++at;
  uvec4 b = texelFetch(records, ivec2(at % width, at / width), 0);
  vec3 ray = uintBitsToFloat(a.xyz) - eye;
  vec3 p = R * ray;
  if (p.z < 0.1) return;
  vec3 s = vec3(uintBitsToFloat(a.w), uintBitsToFloat(b.xy));
  vec4 q = normalize((vec4(b.w & 255u, b.w >> 8 & 255u, b.w >> 16 & 255u, b.w >> 24) - 128.0));
  float w = q.x, x = q.y, y = q.z, z = q.w;
  mat3 M = R * mat3(
    1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y),
    2.0 * (x * y - w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + w * x),
    2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y));
  M[0] *= s.x; M[1] *= s.y; M[2] *= s.z;
  // Slopes are clamped a little outside the picture, as in the rasterizer.
  vec2 low = (-0.15 * size - lens.zw) / lens.xy, high = (1.15 * size - lens.zw) / lens.xy;
  vec2 t = clamp(p.xy / p.z, low, high);
  vec3 ju = vec3(lens.x / p.z, 0.0, -lens.x * t.x / p.z);
  vec3 jv = vec3(0.0, lens.y / p.z, -lens.y * t.y / p.z);
  vec3 mu = ju * M, mv = jv * M;
  float A = dot(mu, mu) + 0.3, B = dot(mu, mv), C = dot(mv, mv) + 0.3, det = A * C - B * B;
  color = vec4(b.z & 255u, b.z >> 8 & 255u, b.z >> 16 & 255u, b.z >> 24) / 255.0;
  if (det <= 0.0 || color.a < 1.0 / 255.0) return;
  if (degree > 0) color.rgb = max(vec3(0.0), color.rgb + seenFrom(normalize(ray)));
  conic = vec3(C, -B, A) / det;
  // Ellipse on which the opacity falls to 1/255, as a box around it.
  float reach = sqrt(2.0 * log(255.0 * color.a));
  offset = corner * reach * sqrt(vec2(A, C));
  vec2 uv = lens.xy * p.xy / p.z + lens.zw + 0.5 + offset;
  if (any(lessThan(uv - offset, -0.5 * size)) || any(greaterThan(uv - offset, 1.5 * size))) return;
  gl_Position = vec4(2.0 * uv.x / size.x - 1.0, 1.0 - 2.0 * uv.y / size.y, 0.0, 1.0);
}`;

export const kFragment = `#version 300 es
precision highp float;
in vec2 offset;
in vec4 color;
flat in vec3 conic;
out vec4 result;
void main() {
  float power = 0.5 * (conic.x * offset.x * offset.x + conic.z * offset.y * offset.y)
              + conic.y * offset.x * offset.y;
  float alpha = min(0.99, color.a * exp(-power));
  if (alpha < 1.0 / 255.0) discard;
  result = vec4(color.rgb * alpha, alpha);
}`;
