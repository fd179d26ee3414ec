// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <stop_token>
#include <vector>

#include "sgs/core/thread_pool.h"
#include "sgs/geometry/pose_correction.h"
#include "sgs/map/gaussian.h"
#include "sgs/map/harmonics.h"
#include "sgs/refine/exposure_curve.h"
#include "sgs/refine/refine_config.h"
#include "sgs/refine/training_frames.h"

namespace sgs::refine {

/// How long to learn: one of the two, the other 0.
struct Budget {
  std::int64_t steps = 0;
  double seconds = 0;  ///< wall time, judging included
};

/// A state of the map, judged.
struct Evaluation {
  std::int64_t steps = 0;  ///< so far
  double share = 0;        ///< of the budget, 0..1
  std::size_t gaussians = 0;
  double psnr_db = 0;          ///< of held-out frames; of training frames where nothing is held out
  double psnr_exposed_db = 0;  ///< the same, as bright as the frames around in time
  bool heldout = true;         ///< which of the two
  bool best = false;           ///< better than all before
};

/// What came of it: the best state by the held-out frames, the beginning included.
struct Refined {
  std::vector<map::Gaussian> gaussians;
  map::Harmonics harmonics;   ///< of those; empty unless learnt or there before
  PoseCorrection correction;  ///< how the training frames moved; what lies between moves along
  ExposureCurve exposures;    ///< of the training frames
  Evaluation start, best, last;
  bool heldout = true;     ///< false: nothing was held out, training frames judged
  bool stopped = false;    ///< by request
  bool exhausted = false;  ///< ended early: nothing improved any more
};

/// Learns a map on from pictures with poses, at full resolution: Gaussians, the poses and
/// exposures of the frames, and more Gaussians where the pictures pull at them (docs/refine.md).
/// With Budget::steps the result is the same to the bit for any number of threads.
class Refiner {
 public:
  /// `training` must not be empty. `pool` may be null (one thread) and must outlive it.
  Refiner(const RefineConfig& config, std::uint64_t seed, std::vector<RefineFrame> training,
          std::vector<RefineFrame> heldout, const map::SplatMap& map, ThreadPool* pool);
  ~Refiner();

  /// Called after each check, with the state as judged; `state` of a best one is what would be
  /// kept.
  using Watch = std::function<void(const Evaluation& now)>;
  /// Learns until the budget is spent, nothing improves or a stop is asked for. Call once.
  Refined run(const Budget& budget, const Watch& watch = {}, const std::stop_token& stop = {});
  /// The best state so far; to be called from Watch.
  const std::vector<map::Gaussian>& best_gaussians() const;
  const map::Harmonics& best_harmonics() const;
  const PoseCorrection& best_correction() const;
  const ExposureCurve& best_exposures() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sgs::refine
