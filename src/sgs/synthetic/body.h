// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "sgs/synthetic/scene.h"

namespace sgs::synthetic {

/// How somebody stands, walks or sits at one moment. World frame, floor at z = 0.
struct Posture {
  Eigen::Vector2f place = Eigen::Vector2f::Zero();  ///< of the middle of the body, metres
  float yaw = 0;                                    ///< where the body faces, rad
  float phase = 0;                                  ///< of the step, rad; 2 pi for both legs
  float stride = 0;                                 ///< 0 standing .. 1 walking briskly
  float sitting = 0;                                ///< 0 upright .. 1 as on a chair
};

/// What a body looks like.
struct Figure {
  float height_m = 1.75f;
  const Texture *shirt = nullptr, *trousers = nullptr;  ///< none = plain
  Rgb shirt_tint = Rgb::Ones(), trousers_tint = Rgb::Ones(), skin = Rgb(0.72f, 0.55f, 0.45f);
};

/// Number of surfaces of a body.
inline constexpr std::size_t kBodyParts = 15;

/// A body of capsules: trunk, head, arms and legs that swing with the step. Always as many, in the
/// same order.
std::array<Primitive, kBodyParts> body(const Figure& figure, const Posture& posture);

}  // namespace sgs::synthetic
