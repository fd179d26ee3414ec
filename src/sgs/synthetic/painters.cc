// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/synthetic/painters.h"

#include <cmath>
#include <memory>

namespace sgs::synthetic {

namespace {

constexpr float kPi = 3.14159265f;

float smooth_step(float lo, float hi, float x) {
  const float t = std::clamp((x - lo) / (hi - lo), 0.f, 1.f);
  return t * t * (3 - 2 * t);
}

// One colour mottled by two fractals: the first shades, the second cuts sharp-edged blotches.
void mottled_row(Canvas& canvas, int y, std::uint64_t seed, const Rgb& base, const Rgb& blotch,
                 float contrast, float cell_m) {
  const int w = canvas.width();
  const float cell = std::max(4.f, cell_m * canvas.scale());
  std::vector<float> a(static_cast<std::size_t>(w)), b(a.size());
  fractal_row({cell, cell, 8, 0.7f}, hash64(seed, 1), w, y, a.data());
  if (contrast > 0.1f)
    fractal_row({cell * 1.7f, cell * 1.7f, 7, 0.6f}, hash64(seed, 2), w, y, b.data());
  for (int x = 0; x < w; ++x) {
    const std::size_t i = static_cast<std::size_t>(x);
    const float cut = contrast > 0.1f ? smooth_step(0.28f, 0.33f, b[i]) : 0.f;
    canvas.set(x, y, (base + cut * (blotch - base)) * (1 + contrast * a[i]));
  }
}

void paint_wood(Canvas& canvas, std::uint64_t seed, const Rgb& base) {
  const int w = canvas.width();
  const float s = canvas.scale();
  std::vector<float> warp(static_cast<std::size_t>(w)), fibre(warp.size());
  for (int y = 0; y < canvas.height(); ++y) {
    fractal_row({0.6f * s, 0.12f * s, 5, 0.5f}, hash64(seed, 1), w, y, warp.data());
    fractal_row({0.15f * s, 0.006f * s, 4, 0.7f}, hash64(seed, 2), w, y, fibre.data());
    for (int x = 0; x < w; ++x) {
      const std::size_t i = static_cast<std::size_t>(x);
      const float ring = std::sin(float(y) / s * 90 + 9 * warp[i]);
      canvas.set(x, y, base * (1 + 0.14f * ring * std::abs(ring) + 0.16f * fibre[i]));
    }
  }
}

void paint_text(Canvas& c, float x0, float y0, float x1, float y1, float height, const Rgb& ink,
                Random& random) {
  for (float y = y0; y + height < y1; y += 1.6f * height) {
    const float end = random.chance(0.2f) ? x0 + (x1 - x0) * random.uniform(0.3f, 0.9f) : x1;
    for (float x = x0; x + height * 0.6f < end; x += 0.75f * height) {
      if (random.chance(0.16f)) continue;
      const auto point = [&] {
        return Eigen::Vector2f(x + height * 0.3f * float(random.integer(0, 2)),
                               y + height * 0.5f * float(random.integer(0, 2)));
      };
      for (int k = random.integer(2, 3); k > 0; --k) {
        const Eigen::Vector2f from = point();
        c.stroke(from, point(), 0.16f * height, ink);
      }
    }
  }
}

// Sky over layers of hills over blotchy ground, and a few objects, in [x0, x1) x [y0, y1).
void paint_photo(Canvas& c, int x0, int y0, int x1, int y1, std::uint64_t seed) {
  Random random(seed);
  const int w = x1 - x0, h = y1 - y0;
  if (w < 4 || h < 4) return;
  const float unit = float(std::min(w, h));
  const Rgb sky = random_color(random, 0.1f, 0.6f, 0.5f, 0.95f);
  constexpr int kLayers = 4;
  Rgb near_color[kLayers], far_color[kLayers];
  std::vector<float> crest[kLayers];
  for (int k = 0; k < kLayers; ++k) {
    near_color[k] = random_color(random, 0.15f, 0.8f, 0.1f, 0.85f);
    far_color[k] = random_color(random, 0.15f, 0.8f, 0.1f, 0.9f);
    crest[k].resize(static_cast<std::size_t>(w));
    fractal_row({unit * 0.6f, unit, 7, 0.6f}, hash64(seed, 10 + static_cast<std::uint64_t>(k)), w,
                0, crest[k].data());
    for (float& v : crest[k]) v = float(h) * (0.15f + 0.22f * float(k)) + 0.13f * unit * v;
  }
  std::vector<float> a(static_cast<std::size_t>(w)), b(a.size());
  for (int y = 0; y < h; ++y) {
    fractal_row({unit * 0.3f, unit * 0.2f, 8, 0.75f}, hash64(seed, 1), w, y, a.data());
    fractal_row({unit * 0.25f, unit * 0.2f, 6, 0.65f}, hash64(seed, 2), w, y, b.data());
    for (int x = 0; x < w; ++x) {
      const std::size_t i = static_cast<std::size_t>(x);
      Rgb color = sky * (0.85f + 0.2f * float(y) / float(h)) + 0.22f * smooth_step(0, 0.6f, b[i]);
      for (int k = 0; k < kLayers; ++k)
        if (float(y) > crest[k][i]) {
          const float cut = smooth_step(0.02f, 0.1f, b[i] + 0.25f * float(k % 2) - 0.1f);
          color = (near_color[k] + cut * (far_color[k] - near_color[k])) * (1 + 0.4f * a[i]);
        }
      c.set(x0 + x, y0 + y, color);
    }
  }
}

void paint_poster(Canvas& c, std::uint64_t seed) {
  Random random(seed);
  const float w = float(c.width()), h = float(c.height()), unit = std::min(w, h);
  c.fill(random_color(random, 0.02f, 0.6f, 0.55f, 0.97f));
  const Rgb ink = random_color(random, 0.0f, 0.8f, 0.03f, 0.3f);
  if (random.chance(0.7f))
    c.rectangle(0, 0, w, h * random.uniform(0.08f, 0.2f),
                random_color(random, 0.3f, 0.9f, 0.2f, 0.8f));
  for (int k = random.integer(1, 4); k > 0; --k) {
    const Eigen::Vector2f p(random.uniform(0, w), random.uniform(0, h));
    const Eigen::Vector2f r(random.uniform(0.05f, 0.25f) * unit,
                            random.uniform(0.05f, 0.25f) * unit);
    c.ellipse(p, r, random.uniform(0, kPi), random_color(random, 0.2f, 0.9f, 0.2f, 0.95f), 0.9f);
  }
  const float m = 0.05f * unit;
  paint_text(c, m, m, w - m, 0.2f * h, random.uniform(0.05f, 0.09f) * unit, ink, random);
  for (float y = 0.22f * h; y < 0.9f * h;) {
    const float step = random.uniform(0.18f, 0.4f) * h, end = std::min(y + step, 0.97f * h);
    const float split = random.uniform(0.35f, 0.65f) * w;
    for (int side = 0; side < 2; ++side) {
      const float left = side == 0 ? m : split + m / 2, right = side == 0 ? split - m / 2 : w - m;
      if (random.chance(0.55f))
        paint_photo(c, int(left), int(y), int(right), int(end - m / 2), random.bits());
      else
        paint_text(c, left, y, right, end - m / 2, random.uniform(0.018f, 0.045f) * unit, ink,
                   random);
    }
    y = end;
  }
}

}  // namespace

Rgb random_color(Random& random, float saturation_lo, float saturation_hi, float value_lo,
                 float value_hi) {
  const float hue = random.uniform(0, 6), s = random.uniform(saturation_lo, saturation_hi);
  const float v = random.uniform(value_lo, value_hi);
  Rgb color;
  for (int k = 0; k < 3; ++k) {
    const float d = std::abs(std::remainder(hue - 2 * float(k), 6.f));
    color[k] = v * (1 - s * std::clamp(d - 1, 0.f, 1.f));
  }
  return color;
}

void paint(Canvas& canvas, Pattern pattern, std::uint64_t seed, const Rgb& base) {
  Random random(seed);
  switch (pattern) {
    case Pattern::kPlain:
      canvas.fill(base);
      break;
    case Pattern::kPlaster:
    case Pattern::kCarpet: {
      const bool carpet = pattern == Pattern::kCarpet;
      const Rgb blotch = base * random.uniform(0.5f, 0.8f);
      for (int y = 0; y < canvas.height(); ++y)
        mottled_row(canvas, y, seed, base, blotch, carpet ? 0.35f : 0.05f, carpet ? 0.3f : 0.5f);
      break;
    }
    case Pattern::kWood:
      paint_wood(canvas, seed, base);
      break;
    case Pattern::kPhoto:
      paint_photo(canvas, 0, 0, canvas.width(), canvas.height(), seed);
      break;
    case Pattern::kPoster:
      paint_poster(canvas, seed);
      break;
    case Pattern::kText:
      canvas.fill(random_color(random, 0.f, 0.2f, 0.8f, 0.97f));
      paint_text(canvas, 4, 4, float(canvas.width()) - 4, float(canvas.height()) - 4,
                 0.012f * canvas.scale(), random_color(random, 0, 0.5f, 0.02f, 0.25f), random);
      break;
  }
}

void scatter_posters(Canvas& canvas, const PosterOptions& options, std::uint64_t seed,
                     ThreadPool& pool) {
  struct Sheet {
    Canvas picture;
    Eigen::Vector2f centre;
    float angle;
  };
  Random random(seed);
  std::vector<Sheet> sheets;
  const float step = options.spacing_m * canvas.scale();
  for (float y = 0.5f * step; y < float(canvas.height()); y += step)
    for (float x = 0.5f * step; x < float(canvas.width()); x += step) {
      if (random.chance(0.12f)) continue;
      const float jitter = options.turned ? 0.25f * step : 0.08f * step;
      const float size = options.size_m * random.uniform(0.6f, 1.15f) * canvas.scale();
      const float aspect = random.chance(0.5f) ? 0.71f : 1.41f;
      const int w = std::max(8, int(size * std::sqrt(aspect)));
      const int h = std::max(8, int(size / std::sqrt(aspect)));
      sheets.push_back(
          {Canvas(w, h, canvas.texel_m()),
           {x + random.uniform(-jitter, jitter), y + random.uniform(-jitter, jitter)},
           options.turned ? random.uniform(-kPi, kPi) : random.uniform(-0.03f, 0.03f)});
    }
  pool.run(int(sheets.size()), [&](int i, int) {
    const std::uint64_t id = hash64(seed, 1000 + static_cast<std::uint64_t>(i));
    paint(sheets[std::size_t(i)].picture, id % 3 == 0 ? Pattern::kPhoto : Pattern::kPoster, id,
          Rgb::Ones());
  });
  constexpr int kStrip = 64;
  pool.run((canvas.height() + kStrip - 1) / kStrip, [&](int strip, int) {
    const int end = std::min(canvas.height(), (strip + 1) * kStrip);
    for (const Sheet& s : sheets) canvas.paste(s.picture, s.centre, s.angle, strip * kStrip, end);
  });
}

}  // namespace sgs::synthetic
