// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "sgs/synthetic/scene_table.h"

namespace sgs::synthetic {

namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

// What a trajectory looks at, sampled sparsely: everything the layout of a scene needs to know.
struct Views {
  std::vector<double> time;
  std::vector<Vector3f> eye, forward;
  std::vector<std::vector<Vector3f>> corners;  // directions to the image corners

  Views(const Trajectory& trajectory, const PinholeCamera& camera) {
    double next = -1e300;
    for (const StampedPose& p : trajectory.poses()) {
      if (p.timestamp_s < next) continue;
      next = p.timestamp_s + 0.1;
      time.push_back(p.timestamp_s);
      eye.push_back(p.T_world_camera.t.cast<float>());
      forward.push_back(p.T_world_camera.R.col(2).cast<float>());
      corners.emplace_back();
      for (double u : {0.0, camera.width - 1.0})
        for (double v : {0.0, camera.height - 1.0})
          corners.back().push_back(
              (p.T_world_camera.R * camera.back_project(u, v, 1)).cast<float>());
    }
  }
  Eigen::AlignedBox3f eyes() const {
    Eigen::AlignedBox3f box;
    for (const Vector3f& p : eye) box.extend(p);
    return box;
  }
  // Mean horizontal viewing direction; x where the views go all ways.
  Vector3f heading() const {
    Vector3f sum = Vector3f::Zero();
    for (const Vector3f& d : forward) sum += Vector3f(d.x(), d.y(), 0);
    return sum.norm() > 0.2f * float(forward.size()) ? sum.normalized().eval()
                                                     : Vector3f::UnitX().eval();
  }
  // Box of what the corner rays hit of the plane z = 0 within `reach`, for times in [from, to].
  Eigen::AlignedBox2f floor_seen(float reach, double from, double to) const {
    Eigen::AlignedBox2f box;
    for (std::size_t i = 0; i < eye.size(); ++i) {
      if (time[i] < from || time[i] > to) continue;
      box.extend(Vector2f(eye[i].head<2>()));
      for (const Vector3f& d : corners[i]) {
        const float s = d.z() < -1e-3f ? std::min(-eye[i].z() / d.z(), reach) : reach;
        box.extend(Vector2f((eye[i] + s * d).head<2>()));
      }
    }
    return box;
  }
  // Median of where the optical axes meet the plane z = `height`.
  Vector2f centre_at(float height) const {
    std::vector<float> x, y;
    for (std::size_t i = 0; i < eye.size(); ++i) {
      const float s = forward[i].z() < -0.05f ? (eye[i].z() - height) / -forward[i].z() : 1.5f;
      const Vector3f p = eye[i] + std::clamp(s, 0.2f, 3.f) * forward[i];
      x.push_back(p.x());
      y.push_back(p.y());
    }
    const auto middle = [](std::vector<float>& v) {
      std::nth_element(v.begin(), v.begin() + std::ptrdiff_t(v.size() / 2), v.end());
      return v[v.size() / 2];
    };
    return {middle(x), middle(y)};
  }
  float clearance(const Vector3f& p) const {
    float best = 1e9f;
    for (const Vector3f& e : eye) best = std::min(best, (e - p).norm());
    return best;
  }
};

class Builder {
 public:
  Builder(const Trajectory& trajectory, const PinholeCamera& camera, std::uint64_t seed,
          ThreadPool& pool)
      : views(trajectory, camera),
        random(hash64(seed, hash_name("layout"))),
        scene(std::make_shared<Scene>()),
        pool_(pool),
        detail_(535.f / float(camera.fx)) {}

  Views views;
  Random random;
  std::shared_ptr<Scene> scene;

  Canvas canvas(float width_m, float height_m, float texel_m) const {
    // Smaller cameras need coarser pictures; nothing needs more than 4096 texels.
    const float texel = std::max({texel_m * detail_, width_m / 4096, height_m / 4096});
    return {std::max(8, int(width_m / texel)), std::max(8, int(height_m / texel)), texel};
  }
  const Texture* keep(Canvas c) {
    scene->textures.emplace_back(std::move(c));
    return &scene->textures.back();
  }
  const Texture* painted(float w, float h, float texel, Pattern pattern, const Rgb& base) {
    Canvas c = canvas(w, h, texel);
    paint(c, pattern, random.bits(), base);
    return keep(std::move(c));
  }
  const Texture* posters(float w, float h, float texel, const Rgb& base, PosterOptions options,
                         Pattern ground = Pattern::kCarpet) {
    Canvas c = canvas(w, h, texel);
    paint(c, ground, random.bits(), base);
    scatter_posters(c, options, random.bits(), pool_);
    return keep(std::move(c));
  }
  Primitive& quad(const Vector3f& centre, const Vector3f& u, const Vector3f& v, float half_u,
                  float half_v, const Texture* texture, const Rgb& tint) {
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
      p.offset = {random.uniform() * std::max(0.f, texture->width_m() - 2 * half_u),
                  random.uniform() * std::max(0.f, texture->height_m() - 2 * half_v)};
    scene->primitives.push_back(p);
    return scene->primitives.back();
  }
  // Standing box without a bottom, turned by `yaw`.
  void box(const Vector3f& centre, const Vector3f& half, float yaw, const Texture* texture,
           const Rgb& tint) {
    const Vector3f x(std::cos(yaw), std::sin(yaw), 0), y(-x.y(), x.x(), 0), z = Vector3f::UnitZ();
    quad(centre + half.z() * z, x, y, half.x(), half.y(), texture, tint);
    quad(centre - half.z() * z, y, x, half.y(), half.x(), texture, tint * 0.8f);
    quad(centre + half.x() * x, y, z, half.y(), half.z(), texture, tint);
    quad(centre - half.x() * x, -y, z, half.y(), half.z(), texture, tint);
    quad(centre + half.y() * y, -x, z, half.x(), half.z(), texture, tint);
    quad(centre - half.y() * y, x, z, half.x(), half.z(), texture, tint);
  }
  void round(Primitive::Kind kind, const Vector3f& centre, float radius, float half_height,
             const Texture* texture, const Rgb& tint) {
    Primitive p;
    p.kind = kind;
    p.centre = centre;
    p.radius = radius;
    p.half_height = half_height;
    p.texture = texture;
    p.tint = tint;
    if (texture) p.offset = {random.uniform(0, 0.2f), random.uniform(0, 0.2f)};
    scene->primitives.push_back(p);
  }
  Primitive& floor(const Eigen::AlignedBox2f& area, float texel, bool textured) {
    const Vector2f c = area.center(), s = area.sizes();
    const Texture* t =
        textured ? posters(s.x(), s.y(), texel, random_color(random, 0.1f, 0.4f, 0.4f, 0.6f),
                           {0.6f, 0.6f, true})
                 : nullptr;
    return quad({c.x(), c.y(), 0}, Vector3f::UnitX(), Vector3f::UnitY(), s.x() / 2, s.y() / 2, t,
                textured ? Rgb(1, 1, 1) : Rgb(0.60f, 0.58f, 0.55f));
  }
  void lights(const Vector3f& centre, float spread) {
    scene->ambient = 0.42f;
    scene->lights = {{centre + Vector3f(0.7f * spread, 0.3f * spread, 2.6f), 0.5f},
                     {centre + Vector3f(-spread, -0.8f * spread, 2.3f), 0.35f}};
  }
  // Four inward walls and a ceiling around `area`.
  void walls(const Eigen::AlignedBox2f& area, float height, bool ceiling) {
    const Vector2f c = area.center(), h = area.sizes() / 2;
    for (int k = 0; k < 4; ++k) {
      const float yaw = float(k) * 1.57079633f;
      const Vector3f inward(std::round(std::cos(yaw)), std::round(std::sin(yaw)), 0);
      const Vector3f along(inward.y(), -inward.x(), 0);
      const float depth = k % 2 == 0 ? h.x() : h.y(), half = k % 2 == 0 ? h.y() : h.x();
      const Texture* t =
          posters(2 * half, height, 0.004f, random_color(random, 0.05f, 0.25f, 0.6f, 0.8f),
                  {1.0f, 0.75f, false}, Pattern::kPlaster);
      quad(Vector3f(c.x(), c.y(), height / 2) - depth * inward, along, -Vector3f::UnitZ(), half,
           height / 2, t, Rgb(1, 1, 1));
    }
    if (ceiling)
      quad({c.x(), c.y(), height}, Vector3f::UnitY(), Vector3f::UnitX(), h.y(), h.x(), nullptr,
           Rgb(0.75f, 0.75f, 0.73f));
  }
  // Pictures that small things are wrapped in.
  void make_sheets() {
    for (int i = 0; i < 10; ++i) {
      const Pattern pattern = i < 4   ? Pattern::kPhoto
                              : i < 7 ? Pattern::kPoster
                              : i < 8 ? Pattern::kText
                                      : Pattern::kCarpet;
      sheets_.push_back(
          painted(0.7f, 0.7f, 0.002f, pattern, random_color(random, 0.2f, 0.7f, 0.4f, 0.8f)));
    }
    wood_ = painted(2.4f, 1.6f, 0.002f, Pattern::kWood, Rgb(0.62f, 0.45f, 0.3f));
  }
  const Texture* sheet() {
    return sheets_[std::size_t(random.integer(0, int(sheets_.size()) - 1))];
  }
  Rgb tint() { return random_color(random, 0.f, 0.3f, 0.75f, 1.f); }

  // Puts one random thing on a surface at `z` unless it would come close to the camera.
  void thing(float x, float y, float z, float size) {
    const float s = size * random.uniform(0.6f, 1.3f), yaw = random.uniform(0, 3.1f);
    const int kind = random.integer(0, 5);
    const float height = kind == 5 ? 2.4f * s : s;
    if (views.clearance({x, y, z + height / 2}) < 0.55f + height) return;
    if (kind == 0)
      round(Primitive::Kind::kSphere, {x, y, z + 0.5f * s}, 0.5f * s, 0, sheet(), tint());
    else if (kind == 1)
      round(Primitive::Kind::kCylinder, {x, y, z + 0.5f * s}, 0.3f * s, 0.5f * s, sheet(), tint());
    else if (kind == 2)  // a pile of books
      for (int k = 0; k < 3; ++k)
        box({x, y, z + s * (0.08f + 0.16f * float(k))}, {0.6f * s, 0.45f * s, 0.08f * s},
            yaw + 0.25f * float(k), sheet(), tint());
    else
      box({x, y, z + height / 2}, {0.5f * s, random.uniform(0.25f, 0.6f) * s, height / 2}, yaw,
          sheet(), tint());
  }
  void desk(const Vector2f& c, const Vector2f& half, int things) {
    constexpr float kHeight = 0.74f;
    quad({c.x(), c.y(), kHeight}, Vector3f::UnitX(), Vector3f::UnitY(), half.x(), half.y(), wood_,
         Rgb(1, 1, 1));
    box({c.x(), c.y(), kHeight - 0.021f}, {half.x(), half.y(), 0.02f}, 0, wood_,
        Rgb(0.8f, 0.8f, 0.8f));
    for (float a : {-1.f, 1.f})
      box({c.x() + a * (half.x() - 0.05f), c.y(), 0.35f}, {0.03f, half.y() - 0.05f, 0.35f}, 0,
          wood_, Rgb(0.7f, 0.7f, 0.7f));
    for (int k = 0; k < things; ++k)
      thing(c.x() + random.uniform(-0.88f, 0.88f) * half.x(),
            c.y() + random.uniform(-0.85f, 0.85f) * half.y(), kHeight, 0.15f);
  }
  void monitor(const Vector3f& foot, float yaw) {
    if (views.clearance(foot + Vector3f(0, 0, 0.3f)) < 0.8f) return;
    const Vector3f f(std::cos(yaw), std::sin(yaw), 0), side(-f.y(), f.x(), 0);
    const Vector3f c = foot + Vector3f(0, 0, 0.3f);
    box(foot + Vector3f(0, 0, 0.05f), {0.03f, 0.03f, 0.05f}, yaw, nullptr, Rgb(0.2f, 0.2f, 0.2f));
    box(c, {0.025f, 0.26f, 0.18f}, yaw, nullptr, Rgb(0.16f, 0.16f, 0.17f));
    quad(c + 0.0265f * f, side, Vector3f::UnitZ(), 0.24f, 0.16f, sheet(), tint()).glow = 0.85f;
  }
  Eigen::AlignedBox2f room_area(float margin) {
    const Eigen::AlignedBox3f e = views.eyes();
    Eigen::AlignedBox2f area(Vector2f(e.min().head<2>()), Vector2f(e.max().head<2>()));
    area.extend(views.centre_at(0.7f));
    return {area.min() - Vector2f::Constant(margin), area.max() + Vector2f::Constant(margin)};
  }
  void clutter_along_walls(const Eigen::AlignedBox2f& area, int count) {
    for (int k = 0; k < count; ++k) {
      const float side = random.uniform(0.25f, 0.6f), along = random.uniform(0.05f, 0.95f);
      Vector2f p = area.min() + along * area.sizes();
      const int wall = k % 4;
      (wall < 2 ? p.x() : p.y()) = wall % 2 == 0
                                       ? (wall < 2 ? area.min().x() : area.min().y()) + side
                                       : (wall < 2 ? area.max().x() : area.max().y()) - side;
      thing(p.x(), p.y(), 0, random.uniform(0.35f, 0.75f));
    }
  }

 private:
  ThreadPool& pool_;
  float detail_;
  std::vector<const Texture*> sheets_;
  const Texture* wood_ = nullptr;
};

void build_floor(Builder& b, const SceneInfo& info) {
  Eigen::AlignedBox2f seen = b.views.floor_seen(7, -1e300, 1e300);
  const float height = b.views.eyes().center().z();
  const Eigen::AlignedBox2f area(seen.min() - Vector2f::Constant(0.7f),
                                 seen.max() + Vector2f::Constant(0.7f));
  const bool textured = info.name != "nostructure_notexture";
  b.lights({area.center().x(), area.center().y(), 0}, 2.5f);
  b.floor(area, height < 1.4f ? 0.002f : 0.0035f, textured);
  if (info.name != "dual") return;
  // A plain sheet a hair above the floor covers all that is seen in the middle three seconds.
  const double middle = 0.5 * (b.views.time.front() + b.views.time.back());
  Eigen::AlignedBox2f plain;
  for (std::size_t i = 0; i < b.views.eye.size(); ++i)
    if (std::abs(b.views.time[i] - middle) <= 1.6)
      for (const Vector3f& d : b.views.corners[i])
        if (d.z() < -1e-3f)
          plain.extend(Vector2f(
              (b.views.eye[i] + std::min(-b.views.eye[i].z() / d.z(), 7.f) * d).head<2>()));
  b.quad({plain.center().x(), plain.center().y(), 0.001f}, Vector3f::UnitX(), Vector3f::UnitY(),
         plain.sizes().x() / 2 + 0.05f, plain.sizes().y() / 2 + 0.05f, nullptr,
         Rgb(0.72f, 0.7f, 0.67f));
}

// Distance along the heading `m` at which a wall stands about `target_m` before the cameras.
float wall_offset(const Views& views, const Vector3f& m, float target_m, float clearance_m) {
  std::vector<float> offsets;
  float nearest = -1e9f;
  for (std::size_t i = 0; i < views.eye.size(); ++i) {
    offsets.push_back(m.dot(views.eye[i] + target_m * views.forward[i]));
    nearest = std::max(nearest, m.dot(views.eye[i]));
  }
  std::nth_element(offsets.begin(), offsets.begin() + std::ptrdiff_t(offsets.size() / 2),
                   offsets.end());
  return std::max(offsets[offsets.size() / 2], nearest + clearance_m);
}

void build_wall_scene(Builder& b, const SceneInfo& info) {
  const bool near = info.name.ends_with("near"), fold = info.name == "fold";
  const Vector3f m = b.views.heading(), side(-m.y(), m.x(), 0), up = Vector3f::UnitZ();
  const float offset = wall_offset(b.views, m, near ? 1.3f : 2.4f, near ? 0.6f : 0.8f);
  const Vector2f look = b.views.centre_at(0.4f);
  const float middle = side.head<2>().dot(look);
  const Vector3f base = offset * m + middle * side;
  b.lights(base - 1.5f * m, 1.8f);
  if (fold) {
    for (float s : {-1.f, 1.f}) {
      const Vector3f along = (s * side - 0.6f * m).normalized();
      const Texture* t = b.posters(4, 7, 0.0035f, random_color(b.random, 0.1f, 0.4f, 0.4f, 0.7f),
                                   {0.6f, 0.6f, true});
      b.quad(base + 0.3f * m + 2 * along + 0.5f * up, along, up, 2, 3.5f, t, Rgb(1, 1, 1))
          .two_sided = true;
    }
    return;
  }
  const Eigen::AlignedBox2f seen = b.views.floor_seen(6, -1e300, 1e300);
  b.floor({seen.min() - Vector2f::Constant(1), seen.max() + Vector2f::Constant(1)}, 0.003f,
          info.textured);
  const float width = near ? 0.55f : 0.8f, amplitude = near ? 0.2f : 0.32f,
              height = near ? 1.3f : 2.0f;
  const int panels = near ? 16 : 14;
  for (int k = 0; k < panels; ++k) {
    const float s = (float(k) - 0.5f * float(panels)) * width;
    const Vector3f p = base + s * side + (k % 2 == 0 ? -amplitude : amplitude) * m;
    const Vector3f q = base + (s + width) * side + (k % 2 == 0 ? amplitude : -amplitude) * m;
    const Vector3f along = q - p;
    const Texture* t = info.textured ? b.posters(along.norm(), height, 0.0025f,
                                                 random_color(b.random, 0.1f, 0.4f, 0.5f, 0.8f),
                                                 {0.45f, 0.45f, true})
                                     : nullptr;
    b.quad((p + q) / 2 + height / 2 * up, along, up, along.norm() / 2, height / 2, t,
           info.textured ? Rgb(1, 1, 1) : Rgb(0.72f, 0.71f, 0.68f))
        .two_sided = true;
  }
}

void build_corridor(Builder& b) {
  const Eigen::AlignedBox3f e = b.views.eyes();
  const bool along_x = e.sizes().x() >= e.sizes().y();
  Eigen::AlignedBox2f area(Vector2f(e.min().head<2>()), Vector2f(e.max().head<2>()));
  const Vector2f margin = along_x ? Vector2f(9, 0.8f) : Vector2f(0.8f, 9);
  area = {Vector2f(area.min() - margin), Vector2f(area.max() + margin)};
  b.lights({area.center().x(), area.center().y(), 0}, 0.5f);
  b.scene->ambient = 0.75f;
  b.walls(area, 2.4f, true);
  b.floor(area, 0.005f, true);
}

void build_room(Builder& b, const SceneInfo& info) {
  b.make_sheets();
  const bool office = info.name == "office", desks = info.name != "room";
  const Eigen::AlignedBox2f area = b.room_area(office ? 0.9f : desks ? 1.5f : 1.9f);
  b.lights({area.center().x(), area.center().y(), 0}, 1.2f);
  b.walls(area, 2.7f, true);
  const Vector2f size = area.sizes();
  b.quad({area.center().x(), area.center().y(), 0}, Vector3f::UnitX(), Vector3f::UnitY(),
         size.x() / 2, size.y() / 2,
         b.painted(size.x(), size.y(), 0.004f, Pattern::kCarpet, Rgb(0.42f, 0.4f, 0.45f)),
         Rgb(1, 1, 1));
  const Vector2f c = b.views.centre_at(0.74f);
  if (office) {
    for (float s : {-1.f, 1.f}) {
      b.desk(c + Vector2f(0, 0.47f * s), {1.1f, 0.42f}, 16);
      for (float x : {-0.6f, 0.5f})
        b.monitor({c.x() + x, c.y() + 0.3f * s, 0.74f}, s * 1.57f + b.random.uniform(-0.3f, 0.3f));
    }
    // Partitions in a cross: most views end at one of them rather than beyond the sensor's range.
    const auto partition = [&](float half_x, float half_y) {
      b.box({c.x(), c.y(), 0.7f}, {half_x, half_y, 0.7f}, 0,
            b.posters(2.4f, 1.4f, 0.003f, random_color(b.random, 0.1f, 0.4f, 0.5f, 0.7f),
                      {0.5f, 0.45f, false}),
            Rgb::Ones());
    };
    partition(1.15f, 0.025f);
    partition(0.025f, 0.9f);
  } else if (desks) {
    b.desk(c, {1.2f, 0.75f}, 34);
    b.monitor({c.x() - 0.3f, c.y() + 0.45f, 0.74f}, -1.3f);
    b.monitor({c.x() + 0.4f, c.y() + 0.45f, 0.74f}, -1.9f);
  }
  b.clutter_along_walls(area, office ? 40 : 28);
}

}  // namespace

std::shared_ptr<const Scene> build_scene(const SceneInfo& info, const Trajectory& trajectory,
                                         const PinholeCamera& camera, std::uint64_t seed,
                                         ThreadPool& pool) {
  Builder b(trajectory, camera, seed, pool);
  if (info.name.starts_with("nostructure") || info.name == "dual")
    build_floor(b, info);
  else if (info.name.starts_with("structure") || info.name == "fold")
    build_wall_scene(b, info);
  else if (info.name == "corridor")
    build_corridor(b);
  else
    build_room(b, info);
  return b.scene;
}

}  // namespace sgs::synthetic
