// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/synthetic/body.h"

#include <cmath>

namespace sgs::synthetic {

namespace {

using Eigen::Vector3f;

// Lengths of a body of 1.75 m, metres.
constexpr float kUsualHeight = 1.75f;
constexpr float kHip = 0.92f, kSeat = 0.47f;      // height of the hips, standing and sitting
constexpr float kShoulder = 0.5f, kHead = 0.71f;  // above the hips
constexpr float kThigh = 0.44f, kShin = 0.4f, kUpperArm = 0.3f, kForearm = 0.26f;

// The axes of a body in the world.
struct Axes {
  Vector3f ahead, left;
  float scale;

  // A vector in the plane of walking: so long, turned forwards from hanging down by an angle.
  Vector3f hanging(float length, float angle) const {
    return scale * length * (std::sin(angle) * ahead - std::cos(angle) * Vector3f::UnitZ());
  }
};

Primitive capsule(const Axes& axes, const Vector3f& from, const Vector3f& to, float radius,
                  const Texture* texture, const Rgb& tint) {
  Primitive p;
  p.kind = Primitive::Kind::kCapsule;
  p.centre = (from + to) / 2;
  const Vector3f along = from - to;
  p.half_height = along.norm() / 2;
  p.u = along.normalized();
  p.v = (axes.left - axes.left.dot(p.u) * p.u).normalized();
  p.radius = axes.scale * radius;
  p.texture = texture;
  p.tint = tint;
  return p;
}

}  // namespace

std::array<Primitive, kBodyParts> body(const Figure& figure, const Posture& posture) {
  const float cos_yaw = std::cos(posture.yaw), sin_yaw = std::sin(posture.yaw);
  const Axes axes{{cos_yaw, sin_yaw, 0}, {-sin_yaw, cos_yaw, 0}, figure.height_m / kUsualHeight};
  const float s = axes.scale, sit = posture.sitting;
  const Vector3f hips(posture.place.x(), posture.place.y(), s * (kHip + sit * (kSeat - kHip)));
  const Vector3f up = s * Vector3f::UnitZ(), left = s * axes.left, ahead = s * axes.ahead;
  std::array<Primitive, kBodyParts> parts;
  std::size_t n = 0;
  const auto add = [&](const Vector3f& from, const Vector3f& to, float radius,
                       const Texture* texture, const Rgb& tint) {
    parts[n++] = capsule(axes, from, to, radius, texture, tint);
  };
  for (const float side : {0.09f, -0.09f}) {  // two beside each other make a trunk
    add(hips + 0.42f * up + side * left, hips + 0.02f * up + side * left, 0.13f, figure.shirt,
        figure.shirt_tint);
  }
  add(hips + (kHead + 0.05f) * up, hips + (kHead - 0.05f) * up, 0.1f, nullptr, figure.skin);
  for (const float side : {1.f, -1.f}) {
    const float step = side * std::sin(posture.phase), swing = 0.55f * posture.stride;
    // The leg that comes forward is bent.
    const float lifted = std::max(0.f, side * std::cos(posture.phase)) * 1.1f * swing;
    const float thigh = (1 - sit) * (swing * step + 0.4f * lifted) + sit * 1.5f;
    const float shin = (1 - sit) * (swing * step - lifted) + sit * 0.05f;
    const Vector3f hip = hips + side * 0.1f * left;
    const Vector3f knee = hip + axes.hanging(kThigh, thigh);
    const Vector3f ankle = knee + axes.hanging(kShin, shin);
    add(hip, knee, 0.085f, figure.trousers, figure.trousers_tint);
    add(knee, ankle, 0.06f, figure.trousers, figure.trousers_tint);
    add(ankle + 0.14f * ahead, ankle, 0.045f, nullptr, Rgb(0.2f, 0.17f, 0.15f));
    const float upper = -0.8f * swing * step + sit * 0.4f, bend = 0.25f + 0.3f * swing + sit;
    const Vector3f shoulder = hips + (kShoulder - 0.04f) * up + side * 0.24f * left;
    const Vector3f elbow = shoulder + axes.hanging(kUpperArm, upper);
    const Vector3f wrist = elbow + axes.hanging(kForearm, upper + bend);
    add(shoulder, elbow, 0.052f, figure.shirt, figure.shirt_tint);
    add(elbow, wrist, 0.042f, figure.shirt, figure.shirt_tint);
    add(wrist + axes.hanging(0.08f, upper + bend), wrist, 0.04f, nullptr, figure.skin);
  }
  return parts;
}

}  // namespace sgs::synthetic
