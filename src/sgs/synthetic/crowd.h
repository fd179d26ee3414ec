// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "sgs/core/thread_pool.h"
#include "sgs/synthetic/body.h"
#include "sgs/synthetic/source.h"
#include "sgs/synthetic/walk_script.h"

namespace sgs::synthetic {

/// Those who move through a scene: walkers at two speeds, who cross the view, stop, sit down, leave
/// and come back, at the distance at which they take the wanted share of it; somebody who stays
/// before the camera; a box that is pushed a way and left there. They walk through furniture.
/// Immutable: the same options and motion, the same people.
class Crowd {
 public:
  /// `motion` is the camera's, `scene` hides them. Seed, camera and who there is: `options`.
  Crowd(const SynthOptions& options, const Scene& scene, const Trajectory& motion,
        ThreadPool& pool);

  /// Their surfaces at a time, always as many in the same order.
  std::vector<Primitive> at(double time_s) const;
  /// By how much each of these surfaces moves in 1/30 s until that time, metres.
  std::vector<float> steps(double time_s) const;

 private:
  struct Person {
    Figure figure;
    WalkScript script;
  };
  void dress(bool plain, std::uint64_t seed);
  void enter(const CrowdOptions& options, const Stage& stage, float distance, std::uint64_t seed);
  const Figure& figure(std::size_t person) const { return figures_[person % figures_.size()]; }

  std::deque<Texture> textures_;  // a deque: figures keep pointers
  std::vector<Figure> figures_;
  std::vector<Person> people_;
  struct PushedBox {
    Posture from, to;  // place and yaw
    double start_s, end_s;
    const Texture* texture;
  };
  std::optional<PushedBox> box_;
};

}  // namespace sgs::synthetic
