// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapper/move_map.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>

#include "sgs/core/error.h"

namespace sgs::mapper {
namespace {

// Places of a Gaussian's floats in a row of moments.
constexpr std::size_t kMean = 0, kRotation = 6;
constexpr double kSmallTurn_rad = 0.035;

float widen(std::uint16_t half) {
  return std::bit_cast<float>(static_cast<std::uint32_t>(half) << 16);
}

std::uint16_t narrow(float value) {
  // To the nearest; what is lost is as much as a step of the optimiser loses.
  return static_cast<std::uint16_t>((std::bit_cast<std::uint32_t>(value) + 0x8000u) >> 16);
}

/// A keyframe's move, ready to be applied to many Gaussians.
struct Move {
  explicit Move(const SE3& T)
      : R(T.R.cast<float>()),
        t(T.t.cast<float>()),
        q(Eigen::Quaternionf(T.quaternion().cast<float>())),
        is_none(T.log().norm() < 1e-7),
        small_turn(T.angle() < kSmallTurn_rad) {}

  void apply(map::Gaussian& g) const {
    Eigen::Map<Eigen::Vector3f> mean(g.mean);
    mean = R * mean + t;
    const Eigen::Quaternionf turned =
        q * Eigen::Quaternionf(g.rotation[0], g.rotation[1], g.rotation[2], g.rotation[3]);
    g.rotation[0] = turned.w();
    g.rotation[1] = turned.x();
    g.rotation[2] = turned.y();
    g.rotation[3] = turned.z();
  }
  void apply(map::Anchor& a) const {
    a.point = R * a.point + t;
    a.normal = R * a.normal;
  }
  void apply(map::Moments& m) const {
    const Eigen::Vector3f gradient =
        R *
        Eigen::Vector3f(widen(m.mean[kMean]), widen(m.mean[kMean + 1]), widen(m.mean[kMean + 2]));
    for (std::size_t k = 0; k < 3; ++k) {
      m.mean[kMean + k] = narrow(gradient[static_cast<Eigen::Index>(k)]);
      if (!small_turn) m.mean_square[kMean + k] = 0;
    }
    for (std::size_t k = kRotation; k < kRotation + 4; ++k) {
      m.mean[k] = 0;
      if (!small_turn) m.mean_square[k] = 0;
    }
  }

  Eigen::Matrix3f R;
  Eigen::Vector3f t;
  Eigen::Quaternionf q;
  bool is_none, small_turn;
};

/// A keyframe's place in the world, for points that its camera has seen.
struct Place {
  explicit Place(const SE3& T) : R(T.R.cast<float>()), t(T.t.cast<float>()) {}

  void apply(const DepthChange& change, const Eigen::Vector3f& normal, map::Gaussian& g) const {
    Eigen::Map<Eigen::Vector3f> mean(g.mean);
    Eigen::Vector3f point = R.transpose() * (mean - t), turned = normal;
    const float before = point.z();
    change.apply(point, turned);
    if (!(before > 0 && point.z() > 0)) return;
    mean = R * point + t;
    for (float& scale : g.log_scale) scale += std::log(point.z() / before);
  }
  void apply(const DepthChange& change, map::GaussianStore& store, std::size_t i) const {
    map::Anchor& anchor = store.anchors[i];
    Eigen::Vector3f point = R.transpose() * (anchor.point - t);
    Eigen::Vector3f normal = R.transpose() * anchor.normal;
    apply(change, normal, store.raw[i]);
    apply(change, normal, store.average[i]);
    change.apply(point, normal);
    anchor.point = R * point + t;
    anchor.normal = R * normal;
  }

  Eigen::Matrix3f R;
  Eigen::Vector3f t;
};

}  // namespace

void change_depth(std::span<const SE3> T_world_keyframe, const DepthChange& change,
                  map::GaussianStore& store) {
  std::vector<Place> places;
  places.reserve(T_world_keyframe.size());
  for (const SE3& T : T_world_keyframe) places.emplace_back(T);
  for (std::size_t i = 0; i < store.size(); ++i) {
    const std::int32_t keyframe = store.anchors[i].keyframe;
    if (keyframe < 0) continue;
    SGS_CHECK(static_cast<std::size_t>(keyframe) < places.size(), "no such keyframe");
    places[static_cast<std::size_t>(keyframe)].apply(change, store, i);
  }
}

void move_gaussians(std::span<const SE3> moves, map::GaussianStore& store) {
  std::vector<Move> ready;
  ready.reserve(moves.size());
  for (const SE3& T : moves) ready.emplace_back(T);
  for (std::size_t i = 0; i < store.size(); ++i) {
    const std::int32_t keyframe = store.anchors[i].keyframe;
    if (keyframe < 0) continue;
    SGS_CHECK(static_cast<std::size_t>(keyframe) < ready.size(), "a move for every keyframe");
    const Move& move = ready[static_cast<std::size_t>(keyframe)];
    if (move.is_none) continue;
    move.apply(store.raw[i]);
    move.apply(store.average[i]);
    move.apply(store.anchors[i]);
    move.apply(store.moments[i]);
  }
}

}  // namespace sgs::mapper
