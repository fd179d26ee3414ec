// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/synthetic/infrared.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "sgs/synthetic/random.h"

namespace sgs::synthetic {

namespace {

constexpr int kMatchRows = 16;
constexpr std::uint16_t kNoSurface = 0xffff;
// What fails together is of about the size of the correlation windows.
constexpr float kFailing_px = 5;

// Walls, floors and tables are matt.
bool is_small(const Primitive& p) {
  constexpr float kLargest_m2 = 0.6f;
  return p.kind != Primitive::Kind::kQuad || 4 * p.half_u * p.half_v < kLargest_m2;
}

PinholeCamera beside(const PinholeCamera& color, const InfraredModel& model) {
  const double scale = color.width / 640.0;
  PinholeCamera camera = color;
  camera.fx *= model.focal_ratio;
  camera.fy *= model.focal_ratio;
  camera.cx = (color.width - 1) / 2.0 + scale * model.offset_x_px;
  camera.cy = (color.height - 1) / 2.0 + scale * model.offset_y_px;
  return camera;
}

struct Extremes {
  float least, most;
};

// Of the depths about a pixel that are there.
Extremes depths_around(const RayImage& seen, int x, int y) {
  constexpr std::array<std::array<int, 2>, 9> kAround = {
      {{0, 0}, {2, 0}, {-2, 0}, {0, 2}, {0, -2}, {1, 1}, {1, -1}, {-1, 1}, {-1, -1}}};
  Extremes e{1e9f, 0};
  for (const auto& [dx, dy] : kAround) {
    const int u = std::clamp(x + dx, 0, seen.width - 1), v = std::clamp(y + dy, 0, seen.height - 1);
    const float z = seen.depth[static_cast<std::size_t>(v) * static_cast<std::size_t>(seen.width) +
                               static_cast<std::size_t>(u)];
    if (z <= 0) continue;
    e.least = std::min(e.least, z);
    e.most = std::max(e.most, z);
  }
  return e;
}

}  // namespace

// Smooth random numbers along the rows of one image.
struct Infrared::Fields {
  SmoothField fixed, passing, sideways, upwards, losses;

  Fields(const RayImage& image, std::uint64_t always, std::uint64_t now, float cell)
      : fixed(image.width, image.height, cell, hash64(always, 1)),
        passing(image.width, image.height, cell, hash64(now, 2)),
        sideways(image.width, image.height, cell, hash64(now, 3)),
        upwards(image.width, image.height, cell, hash64(now, 4)),
        losses(image.width, image.height, cell, hash64(now, 5)) {}
};

Infrared::Infrared(const InfraredModel& model, const Scene& scene,
                   std::span<const Primitive> movers, const LensCamera& color,
                   const Eigen::Vector2d& shift_px, std::uint64_t seed)
    : model_(model),
      color_(color),
      camera_(beside(color.camera, model)),
      T_color_infrared_(Eigen::Matrix3d::Identity(), {-model.baseline_m, 0, 0}),
      shift_px_(shift_px),
      seed_(hash64(seed, hash_name("infrared"))) {
  constexpr float kDark = 0.04f, kMirror = 0.15f;  // of the light that paint throws back
  Random random(hash64(seed_, 1));
  const auto make = [&](const Primitive& p) {
    Material m;
    const bool dark = random.chance(model.dark_objects), shiny = random.chance(model.shiny_objects);
    // Screens are dark glass.
    if (p.glow > 0 || (is_small(p) && dark)) m.reflectance = kDark;
    if (p.glow > 0 || (is_small(p) && shiny)) m.shiny = true;
    if (m.shiny) m.reflectance = std::min(m.reflectance, kMirror);
    materials_.push_back(m);
  };
  for (const Primitive& p : scene.primitives) make(p);
  for (const Primitive& p : movers) make(p);
}

// Light falls with the square of the distance, and twice with the cosine: it is spread over more
// surface, and the pattern is squeezed. Head on, mirrors blind.
bool Infrared::too_dim(const RayImage& seen, std::size_t i, float limit) const {
  constexpr float kBlinding = 0.99f, kInkInInfrared = 0.6f;
  const Material& material = materials_[seen.surface[i]];
  const float cosine = seen.cosine[i], z = seen.depth[i];
  if (material.shiny && cosine > kBlinding) return true;
  // Inks that are dark to the eye are mostly not to infrared.
  const float paint = kInkInInfrared + (1 - kInkInInfrared) * seen.paint[i];
  return material.reflectance * paint * cosine * cosine < limit * z * z;
}

void Infrared::match_row(const RayImage& seen, int y, const Fields& fields, std::uint64_t key,
                         RayImage& out) const {
  const std::size_t w = static_cast<std::size_t>(seen.width);
  const auto along = [&](const SmoothField& field) {
    std::vector<float> row(w);
    field.row(y, row.data());
    return row;
  };
  const auto fixed = along(fields.fixed), passing = along(fields.passing);
  const auto sideways = along(fields.sideways), upwards = along(fields.upwards);
  const auto losses = along(fields.losses);
  for (std::size_t x = 0; x < w; ++x) {
    const std::size_t i = static_cast<std::size_t>(y) * w + x;
    if (seen.surface[i] == kNoSurface) continue;
    const Extremes e = depths_around(seen, static_cast<int>(x), y);
    std::size_t from = i;
    const bool silhouette = e.most - e.least > 0.02f + 0.03f * e.least;
    if (silhouette) {
      const auto moved = [&](float by, std::size_t at, int n) {
        const float to = std::round(static_cast<float>(at) + model_.ragged_px * by);
        return static_cast<std::size_t>(std::clamp(to, 0.f, static_cast<float>(n - 1)));
      };
      from = moved(upwards[x], static_cast<std::size_t>(y), seen.height) * w +
             moved(sideways[x], x, seen.width);
      if (seen.surface[from] == kNoSurface) from = i;
    }
    const float limit =
        model_.dimmest * std::exp(model_.patchiness * 0.7f * (fixed[x] + passing[x]));
    out.depth[i] = 0;
    if (too_dim(seen, from, limit) || (silhouette && losses[x] < model_.edge_limit)) continue;
    out.depth[i] = seen.depth[from];
    out.cosine[i] = seen.cosine[from];
    const std::uint64_t h = hash64(key + i);
    if (!silhouette || unit_float(h) >= model_.flying) continue;
    const float share = unit_float(hash64(h));  // of the farther side, in inverse depth
    out.depth[i] = 1 / (1 / e.least + share * (1 / e.most - 1 / e.least));
  }
}

RayImage Infrared::matched(const RayImage& seen, std::int64_t frame, ThreadPool& pool) const {
  const std::uint64_t now = hash64(seed_, static_cast<std::uint64_t>(frame) + 100);
  const Fields fields(seen, seed_, now,
                      std::max(2.f, kFailing_px * static_cast<float>(seen.width) / 640));
  RayImage out = seen;
  pool.run((seen.height + kMatchRows - 1) / kMatchRows, [&](int strip, int) {
    for (int y = strip * kMatchRows; y < std::min(seen.height, (strip + 1) * kMatchRows); ++y)
      match_row(seen, y, fields, now, out);
  });
  return out;
}

namespace {

// Where the table's steps leave out a pixel on a surface, the driver's images show its neighbour's
// depth twice.
void double_neighbours(DepthImage& depth) {
  constexpr float kSameSurface = 0.02f;
  for (int y = 0; y < depth.height(); ++y) {
    float* row = depth.row(y);
    for (int x = 1; x + 1 < depth.width(); ++x) {
      const float left = row[x - 1], right = row[x + 1];
      if (row[x] == 0 && left > 0 && right > 0 && std::abs(left - right) < kSameSurface * left)
        row[x] = left;
    }
  }
}

}  // namespace

DepthImage Infrared::registered(const DepthImage& depth) const {
  DepthImage out(color_.camera.width, color_.camera.height);
  const PinholeCamera& c = color_.camera;
  for (int y = 0; y < depth.height(); ++y)
    for (int x = 0; x < depth.width(); ++x) {
      const float z = depth(x, y);
      if (z <= 0) continue;
      const Eigen::Vector3d p = T_color_infrared_ * camera_.back_project(x, y, double{z});
      const Eigen::Vector2d bent = color_.distortion.apply(p.head<2>() / p.z());
      const int u = static_cast<int>(std::lround(c.fx * bent.x() + c.cx + shift_px_.x()));
      const int v = static_cast<int>(std::lround(c.fy * bent.y() + c.cy + shift_px_.y()));
      if (!out.contains(u, v)) continue;
      float& there = out(u, v);
      if (there == 0 || z < there) there = z;
    }
  double_neighbours(out);
  return out;
}

}  // namespace sgs::synthetic
