// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <vector>

#include "sgs/core/thread_pool.h"
#include "sgs/synthetic/painters.h"
#include "sgs/synthetic/random.h"
#include "sgs/synthetic/scene.h"
#include "sgs/synthetic/trajectory_views.h"

namespace sgs::synthetic {

/// Puts surfaces and furniture into a scene around a trajectory, at random but always alike for a
/// seed and an order of calls. World frame, z up, metres.
class SceneBuilder {
 public:
  SceneBuilder(const Trajectory& trajectory, const PinholeCamera& camera, std::uint64_t seed,
               ThreadPool& pool);

  const TrajectoryViews& views() const { return views_; }
  Random& random() { return random_; }
  Scene& scene() { return *scene_; }
  /// The scene as it stands now.
  std::shared_ptr<const Scene> finished() const { return scene_; }

  /// A texture of one pattern all over.
  const Texture* painted(float w, float h, float texel, Pattern pattern, const Rgb& base);
  /// A texture of posters on a ground.
  const Texture* posters(float w, float h, float texel, const Rgb& base, PosterOptions options,
                         Pattern ground = Pattern::kCarpet);

  /// A rectangle with axes along `u` and `v`, seen from the side of u x v.
  Primitive& quad(const Eigen::Vector3f& centre, const Eigen::Vector3f& u, const Eigen::Vector3f& v,
                  float half_u, float half_v, const Texture* texture, const Rgb& tint);
  /// Standing box without a bottom, turned by `yaw`.
  void box(const Eigen::Vector3f& centre, const Eigen::Vector3f& half, float yaw,
           const Texture* texture, const Rgb& tint);
  /// A sphere or a standing cylinder.
  void round(Primitive::Kind kind, const Eigen::Vector3f& centre, float radius, float half_height,
             const Texture* texture, const Rgb& tint);
  Primitive& floor(const Eigen::AlignedBox2f& area, float texel, bool textured);
  /// Ambient light and two lamps above `centre`, about `spread` away from it.
  void lights(const Eigen::Vector3f& centre, float spread);
  /// Four inward walls and a ceiling around `area`.
  void walls(const Eigen::AlignedBox2f& area, float height, bool ceiling);

  /// Pictures that small things are wrapped in; call it before the functions below.
  void make_sheets();
  /// Puts one random thing on a surface at `z` unless it would come close to the camera.
  void thing(float x, float y, float z, float size);
  /// A desk with so many things on it.
  void desk(const Eigen::Vector2f& c, const Eigen::Vector2f& half, int things);
  /// A glowing monitor that faces along `yaw`, unless it would come close to the camera.
  void monitor(const Eigen::Vector3f& foot, float yaw);
  /// Things on the floor along the four walls in turn.
  void clutter_along_walls(const Eigen::AlignedBox2f& area, int count);
  /// Box of the camera centres and of what they look at, plus a margin.
  Eigen::AlignedBox2f room_area(float margin) const;

 private:
  Canvas canvas(float width_m, float height_m, float texel_m) const;
  const Texture* keep(Canvas c);
  const Texture* sheet();
  Rgb tint();

  TrajectoryViews views_;
  Random random_;
  std::shared_ptr<Scene> scene_;
  ThreadPool& pool_;
  float detail_;  ///< texels of smaller cameras may be coarser
  std::vector<const Texture*> sheets_;
  const Texture* wood_ = nullptr;
};

}  // namespace sgs::synthetic
