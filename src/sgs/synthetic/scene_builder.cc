// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/synthetic/scene_builder.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sgs::synthetic {

using Eigen::Vector2f;
using Eigen::Vector3f;

SceneBuilder::SceneBuilder(const Trajectory& trajectory, const PinholeCamera& camera,
                           std::uint64_t seed, ThreadPool& pool)
    : views_(trajectory, camera),
      random_(hash64(seed, hash_name("layout"))),
      scene_(std::make_shared<Scene>()),
      pool_(pool),
      detail_(535.f / float(camera.fx)) {}

Canvas SceneBuilder::canvas(float width_m, float height_m, float texel_m) const {
  // Smaller cameras need coarser pictures; nothing needs more than 4096 texels.
  const float texel = std::max({texel_m * detail_, width_m / 4096, height_m / 4096});
  return {std::max(8, int(width_m / texel)), std::max(8, int(height_m / texel)), texel};
}

const Texture* SceneBuilder::keep(Canvas c) {
  scene_->textures.emplace_back(std::move(c));
  return &scene_->textures.back();
}

const Texture* SceneBuilder::painted(float w, float h, float texel, Pattern pattern,
                                     const Rgb& base) {
  Canvas c = canvas(w, h, texel);
  paint(c, pattern, random_.bits(), base);
  return keep(std::move(c));
}

const Texture* SceneBuilder::posters(float w, float h, float texel, const Rgb& base,
                                     PosterOptions options, Pattern ground) {
  Canvas c = canvas(w, h, texel);
  paint(c, ground, random_.bits(), base);
  scatter_posters(c, options, random_.bits(), pool_);
  return keep(std::move(c));
}

Primitive& SceneBuilder::quad(const Vector3f& centre, const Vector3f& u, const Vector3f& v,
                              float half_u, float half_v, const Texture* texture, const Rgb& tint) {
  Primitive p;
  p.centre = centre;
  p.u = u.normalized();
  p.v = v.normalized();
  p.n = p.u.cross(p.v);
  p.half_u = half_u;
  p.half_v = half_v;
  p.texture = texture;
  p.tint = tint;
  if (texture)  // a random window of pictures that are larger than the surface
    p.offset = {random_.uniform() * std::max(0.f, texture->width_m() - 2 * half_u),
                random_.uniform() * std::max(0.f, texture->height_m() - 2 * half_v)};
  scene_->primitives.push_back(p);
  return scene_->primitives.back();
}

void SceneBuilder::box(const Vector3f& centre, const Vector3f& half, float yaw,
                       const Texture* texture, const Rgb& tint) {
  const Vector3f x(std::cos(yaw), std::sin(yaw), 0), y(-x.y(), x.x(), 0), z = Vector3f::UnitZ();
  quad(centre + half.z() * z, x, y, half.x(), half.y(), texture, tint);
  quad(centre - half.z() * z, y, x, half.y(), half.x(), texture, tint * 0.8f);
  quad(centre + half.x() * x, y, z, half.y(), half.z(), texture, tint);
  quad(centre - half.x() * x, -y, z, half.y(), half.z(), texture, tint);
  quad(centre + half.y() * y, -x, z, half.x(), half.z(), texture, tint);
  quad(centre - half.y() * y, x, z, half.x(), half.z(), texture, tint);
}

void SceneBuilder::round(Primitive::Kind kind, const Vector3f& centre, float radius,
                         float half_height, const Texture* texture, const Rgb& tint) {
  Primitive p;
  p.kind = kind;
  p.centre = centre;
  p.radius = radius;
  p.half_height = half_height;
  p.texture = texture;
  p.tint = tint;
  if (texture) p.offset = {random_.uniform(0, 0.2f), random_.uniform(0, 0.2f)};
  scene_->primitives.push_back(p);
}

Primitive& SceneBuilder::floor(const Eigen::AlignedBox2f& area, float texel, bool textured) {
  const Vector2f c = area.center(), s = area.sizes();
  const Texture* t =
      textured ? posters(s.x(), s.y(), texel, random_color(random_, 0.1f, 0.4f, 0.4f, 0.6f),
                         {0.6f, 0.6f, true})
               : nullptr;
  return quad({c.x(), c.y(), 0}, Vector3f::UnitX(), Vector3f::UnitY(), s.x() / 2, s.y() / 2, t,
              textured ? Rgb(1, 1, 1) : Rgb(0.60f, 0.58f, 0.55f));
}

void SceneBuilder::lights(const Vector3f& centre, float spread) {
  scene_->ambient = 0.42f;
  scene_->lights = {{centre + Vector3f(0.7f * spread, 0.3f * spread, 2.6f), 0.5f},
                    {centre + Vector3f(-spread, -0.8f * spread, 2.3f), 0.35f}};
}

void SceneBuilder::walls(const Eigen::AlignedBox2f& area, float height, bool ceiling) {
  const Vector2f c = area.center(), h = area.sizes() / 2;
  for (int k = 0; k < 4; ++k) {
    const float yaw = float(k) * 1.57079633f;
    const Vector3f inward(std::round(std::cos(yaw)), std::round(std::sin(yaw)), 0);
    const Vector3f along(inward.y(), -inward.x(), 0);
    const float depth = k % 2 == 0 ? h.x() : h.y(), half = k % 2 == 0 ? h.y() : h.x();
    const Texture* t =
        posters(2 * half, height, 0.004f, random_color(random_, 0.05f, 0.25f, 0.6f, 0.8f),
                {1.0f, 0.75f, false}, Pattern::kPlaster);
    quad(Vector3f(c.x(), c.y(), height / 2) - depth * inward, along, -Vector3f::UnitZ(), half,
         height / 2, t, Rgb(1, 1, 1));
  }
  if (ceiling)
    quad({c.x(), c.y(), height}, Vector3f::UnitY(), Vector3f::UnitX(), h.y(), h.x(), nullptr,
         Rgb(0.75f, 0.75f, 0.73f));
}

void SceneBuilder::make_sheets() {
  for (int i = 0; i < 10; ++i) {
    const Pattern pattern = i < 4   ? Pattern::kPhoto
                            : i < 7 ? Pattern::kPoster
                            : i < 8 ? Pattern::kText
                                    : Pattern::kCarpet;
    sheets_.push_back(
        painted(0.7f, 0.7f, 0.002f, pattern, random_color(random_, 0.2f, 0.7f, 0.4f, 0.8f)));
  }
  wood_ = painted(2.4f, 1.6f, 0.002f, Pattern::kWood, Rgb(0.62f, 0.45f, 0.3f));
}

const Texture* SceneBuilder::sheet() {
  return sheets_[std::size_t(random_.integer(0, int(sheets_.size()) - 1))];
}

Rgb SceneBuilder::tint() { return random_color(random_, 0.f, 0.3f, 0.75f, 1.f); }

void SceneBuilder::thing(float x, float y, float z, float size) {
  const float s = size * random_.uniform(0.6f, 1.3f), yaw = random_.uniform(0, 3.1f);
  const int kind = random_.integer(0, 5);
  const float height = kind == 5 ? 2.4f * s : s;
  if (views_.clearance({x, y, z + height / 2}) < 0.55f + height) return;
  if (kind == 0)
    round(Primitive::Kind::kSphere, {x, y, z + 0.5f * s}, 0.5f * s, 0, sheet(), tint());
  else if (kind == 1)
    round(Primitive::Kind::kCylinder, {x, y, z + 0.5f * s}, 0.3f * s, 0.5f * s, sheet(), tint());
  else if (kind == 2)  // a pile of books
    for (int k = 0; k < 3; ++k)
      box({x, y, z + s * (0.08f + 0.16f * float(k))}, {0.6f * s, 0.45f * s, 0.08f * s},
          yaw + 0.25f * float(k), sheet(), tint());
  else
    box({x, y, z + height / 2}, {0.5f * s, random_.uniform(0.25f, 0.6f) * s, height / 2}, yaw,
        sheet(), tint());
}

void SceneBuilder::desk(const Vector2f& c, const Vector2f& half, int things) {
  constexpr float kHeight = 0.74f;
  quad({c.x(), c.y(), kHeight}, Vector3f::UnitX(), Vector3f::UnitY(), half.x(), half.y(), wood_,
       Rgb(1, 1, 1));
  box({c.x(), c.y(), kHeight - 0.021f}, {half.x(), half.y(), 0.02f}, 0, wood_,
      Rgb(0.8f, 0.8f, 0.8f));
  for (float a : {-1.f, 1.f})
    box({c.x() + a * (half.x() - 0.05f), c.y(), 0.35f}, {0.03f, half.y() - 0.05f, 0.35f}, 0, wood_,
        Rgb(0.7f, 0.7f, 0.7f));
  for (int k = 0; k < things; ++k)
    thing(c.x() + random_.uniform(-0.88f, 0.88f) * half.x(),
          c.y() + random_.uniform(-0.85f, 0.85f) * half.y(), kHeight, 0.15f);
}

void SceneBuilder::monitor(const Vector3f& foot, float yaw) {
  if (views_.clearance(foot + Vector3f(0, 0, 0.3f)) < 0.8f) return;
  const Vector3f f(std::cos(yaw), std::sin(yaw), 0), side(-f.y(), f.x(), 0);
  const Vector3f c = foot + Vector3f(0, 0, 0.3f);
  box(foot + Vector3f(0, 0, 0.05f), {0.03f, 0.03f, 0.05f}, yaw, nullptr, Rgb(0.2f, 0.2f, 0.2f));
  box(c, {0.025f, 0.26f, 0.18f}, yaw, nullptr, Rgb(0.16f, 0.16f, 0.17f));
  quad(c + 0.0265f * f, side, Vector3f::UnitZ(), 0.24f, 0.16f, sheet(), tint()).glow = 0.85f;
}

Eigen::AlignedBox2f SceneBuilder::room_area(float margin) const {
  const Eigen::AlignedBox3f e = views_.eyes();
  Eigen::AlignedBox2f area(Vector2f(e.min().head<2>()), Vector2f(e.max().head<2>()));
  area.extend(views_.centre_at(0.7f));
  return {area.min() - Vector2f::Constant(margin), area.max() + Vector2f::Constant(margin)};
}

void SceneBuilder::clutter_along_walls(const Eigen::AlignedBox2f& area, int count) {
  for (int k = 0; k < count; ++k) {
    const float side = random_.uniform(0.25f, 0.6f), along = random_.uniform(0.05f, 0.95f);
    Vector2f p = area.min() + along * area.sizes();
    const int wall = k % 4;
    (wall < 2 ? p.x() : p.y()) = wall % 2 == 0
                                     ? (wall < 2 ? area.min().x() : area.min().y()) + side
                                     : (wall < 2 ? area.max().x() : area.max().y()) - side;
    thing(p.x(), p.y(), 0, random_.uniform(0.35f, 0.75f));
  }
}

}  // namespace sgs::synthetic
