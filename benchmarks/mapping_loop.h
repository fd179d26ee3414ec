// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "room_scene.h"
#include "sgs/map/gaussian_store.h"
#include "sgs/mapper/optimizer.h"
#include "sgs/render/rasterizer.h"

namespace sgs::benchmarks {

struct MappingLoopOptions {
  int gaussians = 100000;
  int width = 640;
  bool dense = false;  ///< all Gaussians in view instead of a room of which 40 % are
  double sigma = 0.6;  ///< tangential, in spacings
  int threads = 1;
  float dssim_weight = 0;
};

/// The mapper's inner loop on a fixed view of the benchmark room: one call of iterate() is a
/// complete mapping iteration (forward, L1 of colour and depth, backward, Adam and averaging of the
/// visible Gaussians). Learning rates are so small that the scene stays what it is.
class MappingLoop {
 public:
  explicit MappingLoop(const MappingLoopOptions& options);
  void iterate();
  /// Number of Gaussians that took part in the last iteration.
  std::size_t visible() const;

 private:
  ThreadPool pool_;
  std::unique_ptr<render::Rasterizer> rasterizer_;
  mapper::Optimizer optimizer_;
  map::GaussianStore store_;
  map::MeanBounds bounds_;
  std::shared_ptr<const render::TrainingView> training_;
  SE3 pose_;
  render::LossConfig loss_;
  render::Gradients gradients_;
};

}  // namespace sgs::benchmarks
