// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/tracker/movers/surface_check.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sgs/camera/depth_noise.h"

namespace sgs::tracker {
namespace {

constexpr float kWidths = 3;       // beyond which nothing is noise
constexpr float kSlack_px = 0.5f;  // coarse pixels that a pose may be off by

struct Seen {
  std::size_t cell;
  float depth_off;  // in widths
  float now, then, slope;
};

// Gain and offset between two views: of all that is where it was, robustly.
struct Brightness {
  float gain = 1, offset = 0;
};

Brightness fit_brightness(const std::vector<Seen>& seen, float sigma) {
  constexpr int kFits = 4;
  constexpr double kGainSigma = 0.1;
  Brightness b;
  for (int round = 0; round < kFits; ++round) {
    double w = 0, x = 0, y = 0, xx = 0, xy = 0;
    for (const Seen& s : seen) {
      const float r = s.now - b.gain * s.then - b.offset;
      const float e2 = r * r / (sigma * sigma + kSlack_px * kSlack_px * s.slope * s.slope);
      const double weight = 1 / (1 + double{e2});
      w += weight;
      x += weight * s.then;
      y += weight * s.now;
      xx += weight * s.then * s.then;
      xy += weight * s.then * s.now;
    }
    if (!(w > 0)) return b;
    const double prior = double{sigma} * sigma / (kGainSigma * kGainSigma);
    const double spread = xx - x * x / w + prior;
    const double gain = (xy - x * y / w + prior) / spread;
    b.gain = static_cast<float>(gain);
    b.offset = static_cast<float>((y - gain * x) / w);
  }
  return b;
}

}  // namespace

SurfaceCheck check_surface(const CoarseView& view, const CoarseView& past, const SE3& T_past_view,
                           double sigma) {
  SurfaceCheck out;
  out.columns = view.depth.width() / SurfaceCheck::kCell;
  out.rows = view.depth.height() / SurfaceCheck::kCell;
  out.off.assign(static_cast<std::size_t>(out.columns * out.rows), SurfaceCheck::kUnknown);
  const Eigen::Matrix3f R = T_past_view.R.cast<float>();
  const Eigen::Vector3f t = T_past_view.t.cast<float>();
  const auto f = [](double x) { return static_cast<float>(x); };
  const float fx = f(view.camera.fx), fy = f(view.camera.fy), cx = f(view.camera.cx),
              cy = f(view.camera.cy);
  const float right = f(past.depth.width() - 2), bottom = f(past.depth.height() - 2);
  const float noise = f(sigma) * std::sqrt(2.0f);
  std::vector<Seen> seen;
  seen.reserve(out.off.size());
  for (int row = 0; row < out.rows; ++row) {
    for (int column = 0; column < out.columns; ++column) {
      const int x = column * SurfaceCheck::kCell + 1, y = row * SurfaceCheck::kCell + 1;
      const float z = view.depth(x, y);
      if (!(z > 0)) continue;
      const Eigen::Vector3f p((f(x) - cx) / fx * z, (f(y) - cy) / fy * z, z);
      const Eigen::Vector3f q = R * p + t;
      if (!(q.z() > 0)) continue;
      const float u = q.x() / q.z() * fx + cx, v = q.y() / q.z() * fy + cy;
      if (!(u >= 1 && v >= 1 && u < right && v < bottom)) continue;
      const int iu = static_cast<int>(u), iv = static_cast<int>(v);
      float nearest = std::numeric_limits<float>::infinity(), farthest = 0;
      for (int k = 0; k < 4; ++k) {
        const float d = past.depth(iu + (k & 1), iv + (k >> 1));
        if (!(d > 0)) continue;
        nearest = std::min(nearest, d);
        farthest = std::max(farthest, d);
      }
      if (!(farthest > 0)) continue;
      const auto cell = static_cast<std::size_t>(row * out.columns + column);
      const float width = std::sqrt(2.0f) * depth_sigma_m(q.z());
      const float before = (nearest - q.z()) / width;   // > 0: where nothing stood
      const float behind = (q.z() - farthest) / width;  // > 0: it was hidden, or has receded
      if (behind > kWidths) continue;
      if (before > kWidths) {
        out.off[cell] = 1;
        continue;
      }
      const float du = u - f(iu), dv = v - f(iv);
      const auto g = [&](int a, int b) { return past.gray(iu + a, iv + b); };
      const float then = (1 - dv) * ((1 - du) * g(0, 0) + du * g(1, 0)) +
                         dv * ((1 - du) * g(0, 1) + du * g(1, 1));
      const float gx = 0.5f * (g(1, 0) + g(1, 1) - g(0, 0) - g(0, 1));
      const float gy = 0.5f * (g(0, 1) + g(1, 1) - g(0, 0) - g(1, 0));
      const float now = view.gray(x, y);
      if (std::isnan(now + then)) continue;
      const float nx = 0.5f * (view.gray(x + 1, y) - view.gray(x - 1, y));
      const float ny = y + 1 < view.gray.height()
                           ? 0.5f * (view.gray(x, y + 1) - view.gray(x, y - 1))
                           : 0;
      const float slope = std::sqrt(std::max(gx * gx + gy * gy, nx * nx + ny * ny));
      seen.push_back({cell, std::max({before, behind, 0.0f}), now, then,
                      std::isnan(slope) ? 0 : slope});
    }
  }
  const Brightness b = fit_brightness(seen, noise);
  for (const Seen& s : seen) {
    const float r = s.now - b.gain * s.then - b.offset;
    const float e2 = r * r / (noise * noise + kSlack_px * kSlack_px * s.slope * s.slope);
    const float worst = std::max(e2, s.depth_off * s.depth_off);
    out.off[s.cell] = std::min(1.0f, worst / (kWidths * kWidths));
  }
  for (const float off : out.off) {
    if (off != SurfaceCheck::kUnknown) out.support += 1 - double{off};
  }
  return out;
}

}  // namespace sgs::tracker
