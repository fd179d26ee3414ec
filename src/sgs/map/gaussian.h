// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sgs/geometry/se3.h"
#include "sgs/map/harmonics.h"

namespace sgs::map {

/// The optimised parameters of one 3D Gaussian: one cache line, the layout every renderer reads.
/// (Kerbl et al., 3D Gaussian Splatting, 2023; colour is SH degree 0, stored as plain RGB.)
struct alignas(64) Gaussian {
  float mean[3];        ///< world, metres
  float log_scale[3];   ///< natural logarithm of the standard deviations in metres
  float rotation[4];    ///< quaternion w x y z, world from principal axes, not necessarily unit
  float opacity_logit;  ///< before the sigmoid
  float rgb[3];         ///< linear in the image's values, 0..1, unclamped
  float unused[2];      ///< always 0, so that rows can be combined as vectors
};
static_assert(sizeof(Gaussian) == 64);

/// Opacity of a Gaussian, 0..1.
template <class T = float>
T opacity(const Gaussian& g) {
  return 1 / (1 + std::exp(-static_cast<T>(g.opacity_logit)));
}

/// What a Gaussian was born with; photometric optimisation never changes it. The tracker's
/// geometric target (docs/method.md, section 7) and what moves when its keyframe moves.
struct Anchor {
  Eigen::Vector3f point = Eigen::Vector3f::Zero();   ///< measured point, world
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  ///< unit, towards the camera that saw it
  float sigma_n_m = 0;                               ///< standard deviation along the normal
  std::int32_t keyframe = -1;                        ///< index of the keyframe that inserted it
  std::uint32_t id = 0;  ///< given by the store: rising in order of insertion, never used again
};

/// A map as files hold it.
struct SplatMap {
  std::vector<Gaussian> gaussians;
  Harmonics harmonics;  ///< of those, or none
};

/// Immutable state of the map after some number of keyframes and iterations. What everything
/// outside the mapper reads: tracker, insertion test, viewer, export, evaluation.
struct Snapshot {
  std::uint64_t version = 0;
  std::vector<Gaussian> gaussians;            ///< averaged parameters
  std::vector<Anchor> anchors;                ///< same order and size as `gaussians`
  std::vector<SE3> T_world_keyframe;          ///< refined poses of all mapping keyframes so far
  std::vector<std::int64_t> keyframe_frames;  ///< frame index of each of them
  Harmonics harmonics;                        ///< of a refined map; none while it is made
};
using SnapshotPtr = std::shared_ptr<const Snapshot>;

}  // namespace sgs::map
