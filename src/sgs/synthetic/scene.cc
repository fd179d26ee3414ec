// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/synthetic/scene.h"

#include <algorithm>
#include <cmath>

namespace sgs::synthetic {

namespace {

// From the nearest point of a capsule's axis.
Eigen::Vector3f off_axis(const Primitive& capsule, const Eigen::Vector3f& p) {
  const Eigen::Vector3f d = p - capsule.centre;
  return d - std::clamp(d.dot(capsule.u), -capsule.half_height, capsule.half_height) * capsule.u;
}

}  // namespace

Eigen::Vector3f Primitive::normal(const Eigen::Vector3f& p) const {
  if (kind == Kind::kQuad) return n;
  const Eigen::Vector3f d = p - centre;
  if (kind == Kind::kSphere) return d.normalized();
  if (kind == Kind::kCapsule) return off_axis(*this, p).normalized();
  // The lid where the point is nearer to it than to the side.
  if (half_height - d.z() < radius - d.head<2>().norm()) return Eigen::Vector3f::UnitZ();
  return Eigen::Vector3f(d.x(), d.y(), 0).normalized();
}

Eigen::Vector2f Primitive::surface_uv(const Eigen::Vector3f& p) const {
  const Eigen::Vector3f d = p - centre;
  if (kind == Kind::kQuad) return Eigen::Vector2f(d.dot(u) + half_u, d.dot(v) + half_v) + offset;
  if (kind == Kind::kSphere) {
    // Stereographic from either pole: continuous across the equator.
    const float k = 1.6f * radius / (radius + std::abs(d.z()));
    return Eigen::Vector2f(radius + k * d.x(), radius + k * d.y()) + offset;
  }
  if (kind == Kind::kCapsule) {
    const Eigen::Vector3f w = u.cross(v);
    return Eigen::Vector2f((std::atan2(d.dot(w), d.dot(v)) + 3.14159265f) * radius,
                           half_height + radius - d.dot(u)) +
           offset;
  }
  if (normal(p).z() > 0.5f) return Eigen::Vector2f(radius + d.x(), radius + d.y()) + offset;
  return Eigen::Vector2f((std::atan2(d.y(), d.x()) + 3.14159265f) * radius, half_height - d.z()) +
         offset;
}

float Primitive::distance(const Eigen::Vector3f& p) const {
  const Eigen::Vector3f d = p - centre;
  if (kind == Kind::kQuad) {
    const float a = std::max(0.f, std::abs(d.dot(u)) - half_u);
    const float b = std::max(0.f, std::abs(d.dot(v)) - half_v);
    return Eigen::Vector3f(a, b, d.dot(n)).norm();
  }
  if (kind == Kind::kSphere) return std::abs(d.norm() - radius);
  if (kind == Kind::kCapsule) return std::abs(off_axis(*this, p).norm() - radius);
  const float side = d.head<2>().norm() - radius, lid = std::abs(d.z()) - half_height;
  return std::max(side, lid) > 0 ? Eigen::Vector2f(std::max(side, 0.f), std::max(lid, 0.f)).norm()
                                 : -std::max(side, lid);
}

std::vector<Eigen::Vector3f> Primitive::hull() const {
  std::vector<Eigen::Vector3f> corners;
  if (kind == Kind::kQuad) {
    for (float a : {-1.f, 1.f})
      for (float b : {-1.f, 1.f}) corners.push_back(centre + a * half_u * u + b * half_v * v);
    return corners;
  }
  Eigen::Vector3f half(radius, radius, kind == Kind::kSphere ? radius : half_height);
  if (kind == Kind::kCapsule) half = half_height * u.cwiseAbs() + Eigen::Vector3f::Constant(radius);
  for (float a : {-1.f, 1.f})
    for (float b : {-1.f, 1.f})
      for (float c : {-1.f, 1.f})
        corners.push_back(centre + half.cwiseProduct(Eigen::Vector3f(a, b, c)));
  return corners;
}

}  // namespace sgs::synthetic
