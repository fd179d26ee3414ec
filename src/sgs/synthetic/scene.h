// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <deque>
#include <vector>

#include "sgs/synthetic/canvas.h"
#include "sgs/synthetic/painters.h"

namespace sgs::synthetic {

/// One analytic surface in the world frame (metres).
struct Primitive {
  enum class Kind { kQuad, kSphere, kCylinder, kCapsule };
  Kind kind = Kind::kQuad;
  Eigen::Vector3f centre = Eigen::Vector3f::Zero();
  Eigen::Vector3f u = Eigen::Vector3f::UnitX();  ///< quad: first axis; capsule: along it (unit)
  Eigen::Vector3f v = Eigen::Vector3f::UnitY();  ///< quad: second axis; capsule: across it (unit)
  Eigen::Vector3f n = Eigen::Vector3f::UnitZ();  ///< quad: u x v, the side that is seen
  float half_u = 0, half_v = 0;                  ///< quad: half sizes
  float radius = 0,
        half_height = 0;  ///< sphere; standing cylinder with a lid; capsule: to its caps
  bool two_sided = false;
  const Texture* texture = nullptr;                  ///< none = plain
  Eigen::Vector2f offset = Eigen::Vector2f::Zero();  ///< added to surface coordinates, metres
  Rgb tint = Rgb::Ones();
  float glow = 0;  ///< light of its own, for screens

  /// Unit outward normal at a point on the surface.
  Eigen::Vector3f normal(const Eigen::Vector3f& p) const;
  /// Surface coordinates in metres at a point on the surface.
  Eigen::Vector2f surface_uv(const Eigen::Vector3f& p) const;
  /// Distance of a point from the surface (quads: from the plane and its borders).
  float distance(const Eigen::Vector3f& p) const;
  /// Corners of a box that contains the surface (4 for quads, 8 otherwise).
  std::vector<Eigen::Vector3f> hull() const;
};

struct Light {
  Eigen::Vector3f position;
  float intensity;
};

class Scene {
 public:
  std::vector<Primitive> primitives;
  std::vector<Light> lights;
  float ambient = 0.45f;
  std::deque<Texture> textures;  ///< a deque: primitives keep pointers

  Scene() = default;
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

  /// Reflected light at a point with the given normal, before the texture.
  float irradiance(const Eigen::Vector3f& p, const Eigen::Vector3f& n) const {
    float sum = ambient;
    for (const Light& light : lights) {
      const Eigen::Vector3f l = light.position - p;
      const float d2 = l.squaredNorm(), c = n.dot(l);
      if (c > 0) sum += light.intensity * c / (std::sqrt(d2) * (1 + 0.04f * d2));
    }
    return sum;
  }
};

}  // namespace sgs::synthetic
