// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "sgs/synthetic/floor_plan.h"
#include "sgs/synthetic/scene_builder.h"
#include "sgs/synthetic/scene_table.h"

namespace sgs::synthetic {

namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

void build_floor(SceneBuilder& b, const SceneInfo& info) {
  Eigen::AlignedBox2f seen = b.views().floor_seen(7, -1e300, 1e300);
  const float height = b.views().eyes().center().z();
  const Eigen::AlignedBox2f area(seen.min() - Vector2f::Constant(0.7f),
                                 seen.max() + Vector2f::Constant(0.7f));
  const bool textured = info.name != "nostructure_notexture";
  b.lights({area.center().x(), area.center().y(), 0}, 2.5f);
  b.floor(area, height < 1.4f ? 0.002f : 0.0035f, textured);
  if (info.name != "dual") return;
  // A plain sheet a hair above the floor covers all that is seen in the middle three seconds.
  const double middle = 0.5 * (b.views().time.front() + b.views().time.back());
  Eigen::AlignedBox2f plain;
  for (std::size_t i = 0; i < b.views().eye.size(); ++i)
    if (std::abs(b.views().time[i] - middle) <= 1.6)
      for (const Vector3f& d : b.views().corners[i])
        if (d.z() < -1e-3f)
          plain.extend(Vector2f(
              (b.views().eye[i] + std::min(-b.views().eye[i].z() / d.z(), 7.f) * d).head<2>()));
  b.quad({plain.center().x(), plain.center().y(), 0.001f}, Vector3f::UnitX(), Vector3f::UnitY(),
         plain.sizes().x() / 2 + 0.05f, plain.sizes().y() / 2 + 0.05f, nullptr,
         Rgb(0.72f, 0.7f, 0.67f));
}

// Distance along the heading `m` at which a wall stands about `target_m` before the cameras.
float wall_offset(const TrajectoryViews& views, const Vector3f& m, float target_m,
                  float clearance_m) {
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

void build_wall_scene(SceneBuilder& b, const SceneInfo& info) {
  const bool near = info.name.ends_with("near"), fold = info.name == "fold";
  const Vector3f m = b.views().heading(), side(-m.y(), m.x(), 0), up = Vector3f::UnitZ();
  const float offset = wall_offset(b.views(), m, near ? 1.3f : 2.4f, near ? 0.6f : 0.8f);
  const Vector2f look = b.views().centre_at(0.4f);
  const float middle = side.head<2>().dot(look);
  const Vector3f base = offset * m + middle * side;
  b.lights(base - 1.5f * m, 1.8f);
  if (fold) {
    for (float s : {-1.f, 1.f}) {
      const Vector3f along = (s * side - 0.6f * m).normalized();
      const Texture* t = b.posters(4, 7, 0.0035f, random_color(b.random(), 0.1f, 0.4f, 0.4f, 0.7f),
                                   {0.6f, 0.6f, true});
      b.quad(base + 0.3f * m + 2 * along + 0.5f * up, along, up, 2, 3.5f, t, Rgb(1, 1, 1))
          .two_sided = true;
    }
    return;
  }
  const Eigen::AlignedBox2f seen = b.views().floor_seen(6, -1e300, 1e300);
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
                                                 random_color(b.random(), 0.1f, 0.4f, 0.5f, 0.8f),
                                                 {0.45f, 0.45f, true})
                                     : nullptr;
    b.quad((p + q) / 2 + height / 2 * up, along, up, along.norm() / 2, height / 2, t,
           info.textured ? Rgb(1, 1, 1) : Rgb(0.72f, 0.71f, 0.68f))
        .two_sided = true;
  }
}

void build_corridor(SceneBuilder& b) {
  const Eigen::AlignedBox3f e = b.views().eyes();
  const bool along_x = e.sizes().x() >= e.sizes().y();
  Eigen::AlignedBox2f area(Vector2f(e.min().head<2>()), Vector2f(e.max().head<2>()));
  const Vector2f margin = along_x ? Vector2f(9, 0.8f) : Vector2f(0.8f, 9);
  area = {Vector2f(area.min() - margin), Vector2f(area.max() + margin)};
  b.lights({area.center().x(), area.center().y(), 0}, 0.5f);
  b.scene().ambient = 0.75f;
  b.walls(area, 2.4f, true);
  b.floor(area, 0.005f, true);
}

void build_room(SceneBuilder& b, const SceneInfo& info) {
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
  const Vector2f c = b.views().centre_at(0.74f);
  if (office) {
    for (float s : {-1.f, 1.f}) {
      b.desk(c + Vector2f(0, 0.47f * s), {1.1f, 0.42f}, 16);
      for (float x : {-0.6f, 0.5f})
        b.monitor({c.x() + x, c.y() + 0.3f * s, 0.74f},
                  s * 1.57f + b.random().uniform(-0.3f, 0.3f));
    }
    // Partitions in a cross: most views end at one of them rather than beyond the sensor's range.
    const auto partition = [&](float half_x, float half_y) {
      b.box({c.x(), c.y(), 0.7f}, {half_x, half_y, 0.7f}, 0,
            b.posters(2.4f, 1.4f, 0.003f, random_color(b.random(), 0.1f, 0.4f, 0.5f, 0.7f),
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
  SceneBuilder b(trajectory, camera, seed, pool);
  if (info.name.starts_with("nostructure") || info.name == "dual")
    build_floor(b, info);
  else if (info.name.starts_with("structure") || info.name == "fold")
    build_wall_scene(b, info);
  else if (info.name == "corridor")
    build_corridor(b);
  else if (const auto plan = floor_plan(info.name))
    build_floor_plan(b, *plan, seed);
  else
    build_room(b, info);
  return b.finished();
}

}  // namespace sgs::synthetic
