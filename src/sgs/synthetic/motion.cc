// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include "sgs/synthetic/floor_plan.h"
#include "sgs/synthetic/random.h"
#include "sgs/synthetic/scene_table.h"
#include "sgs/synthetic/source.h"

namespace sgs::synthetic {

namespace {

using Eigen::Vector3d;

// Where the camera is and what it looks at, before the hand shakes.
struct Aim {
  Vector3d eye, target;
};

Aim aim_at(const std::string& scene, double t, double length, const std::array<double, 4>& ph) {
  const double s = t / length;  // 0..1
  const double turn = 2 * M_PI * s;
  const auto wave = [&](double amplitude, double period, std::size_t k) {
    return amplitude * std::sin(2 * M_PI * t / period + ph[k]);
  };
  if (const auto plan = floor_plan(scene)) {
    const Walk walk(plan->route);
    const double metres = 0.3 + s * (walk.length_m() - 1.5);
    const Eigen::Vector2d here = walk.at(metres), ahead = walk.ahead(metres);
    const double yaw = std::atan2(ahead.y(), ahead.x()) + wave(0.2, 7, 0);
    const Vector3d eye(here.x() + wave(0.05, 9, 1), here.y() + wave(0.05, 11, 2),
                       1.42 + wave(0.04, 5, 3));
    return {eye, eye + Vector3d(2 * std::cos(yaw), 2 * std::sin(yaw), -0.85 + wave(0.2, 13, 1))};
  }
  if (scene.starts_with("nostructure") || scene == "dual") {
    const bool near = scene.ends_with("near");
    const double height = near ? 1.0 : 1.9;
    Vector3d eye(near ? 0.9 * std::sin(turn) : wave(0.15, 9, 0),
                 near ? 1.1 * std::cos(turn) : -2.0 + 4.0 * s, height + wave(0.04, 5, 1));
    Vector3d target = eye + Vector3d(wave(0.12, 8, 2), 0.72 * height, 0);
    target.z() = 0;
    return {eye, target};
  }
  if (scene.starts_with("structure") || scene == "fold") {
    const bool near = scene.ends_with("near");
    const double y = (near ? 0.8 : 1.1) * std::sin(turn + ph[0]);
    return {{wave(0.12, 7, 1), y, (near ? 0.75 : 1.05) + wave(0.05, 6, 2)},
            {near ? 1.3 : 2.4, 0.55 * y + wave(0.25, 6.5, 3), near ? 0.35 : 0.55}};
  }
  if (scene == "corridor") {
    const Vector3d eye(-3.2 + 6.4 * s, wave(0.15, 8, 0), 1.3 + wave(0.04, 3.1, 1));
    return {eye, eye + Vector3d(2.2, wave(0.35, 7, 2), -0.75)};
  }
  if (scene == "room") {
    const double yaw = 1.5 * std::sin(turn) + wave(0.2, 7, 3);
    const Vector3d eye(wave(0.5, 13, 0), wave(0.5, 11, 1), 1.35 + wave(0.06, 5, 2));
    return {eye, eye + Vector3d(2 * std::cos(yaw), 2 * std::sin(yaw), -0.9)};
  }
  if (scene == "office") {
    const double a = turn + ph[0], r = 2.1 + wave(0.2, 9, 1);
    return {{r * std::cos(a), 0.9 * r * std::sin(a), 1.45 + wave(0.1, 8, 2)},
            {0.45 * std::cos(a + 0.5), 0.4 * std::sin(a + 0.5), 0.75}};
  }
  // room_desk: a sweep to and fro around one side of the desk.
  const double a = 0.9 * std::sin(turn) - M_PI / 2, r = 1.15 + wave(0.15, 6, 1);
  return {{r * std::cos(a), r * std::sin(a), 1.42 + wave(0.1, 5, 2)},
          {0.55 * std::sin(turn * 2 + ph[0]), 0.15 + wave(0.15, 7, 3), 0.78}};
}

SE3 look_at(const Aim& aim) {
  const Vector3d z = (aim.target - aim.eye).normalized();
  const Vector3d x = z.cross(Vector3d::UnitZ()).normalized();
  Eigen::Matrix3d R;
  R << x, z.cross(x), z;
  return {R, aim.eye};
}

// Tremor of a hand: a few incommensurate sinusoids per axis between 0.4 and 4 Hz, slower ones
// larger.
class HandShake {
 public:
  explicit HandShake(Random& random) {
    for (auto& axis : waves_)
      for (std::size_t k = 0; k < axis.size(); ++k)
        axis[k] = {0.4 * std::pow(1.75, double(k)) * double(random.uniform(0.9f, 1.1f)),
                   double(random.uniform(0, 6.283f))};
  }
  Vector6d at(double t) const {
    Vector6d xi = Vector6d::Zero();
    for (int a = 0; a < 6; ++a)
      for (const Wave& w : waves_[static_cast<std::size_t>(a)])
        xi[a] +=
            (a < 3 ? 0.0035 : 0.0025) / (1 + w.hz * w.hz) * std::sin(2 * M_PI * w.hz * t + w.phase);
    return xi;
  }

 private:
  struct Wave {
    double hz, phase;
  };
  std::array<std::array<Wave, 5>, 6> waves_;
};

}  // namespace

Result<Trajectory> handheld_trajectory(const SynthOptions& options) {
  SGS_ASSIGN_OR_RETURN(const SceneInfo info, find_scene(options.scene));
  Random random(hash64(options.seed, hash_name("motion")));
  std::array<double, 4> phases;
  for (double& p : phases) p = double(random.uniform(0, 6.283f));
  const HandShake shake(random);
  // A shorter sequence is the beginning of the whole motion.
  const double length = info.default_frames / 30.0;
  const double wanted = options.frames > 0 ? options.frames / options.rate_hz : length;
  const double end = std::min(wanted, length) + 0.1;
  Trajectory trajectory;
  for (int k = -20; k * 0.005 <= end; ++k) {
    const double t = k * 0.005;
    trajectory.push_back(
        {1 + t, look_at(aim_at(info.name, t, length, phases)) * SE3::exp(shake.at(t))});
  }
  return trajectory;
}

}  // namespace sgs::synthetic
