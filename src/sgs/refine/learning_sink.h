// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sgs/map/mean_bounds.h"
#include "sgs/mapper/optimizer.h"
#include "sgs/refine/densify.h"

namespace sgs::refine {

/// Steps the Gaussians of one view while its backward pass runs, keeps them no thinner than the
/// pictures can tell, and notes how hard the picture pulls at each.
class LearningSink final : public render::GradientSink {
 public:
  /// All must outlive this; sizes stay as they are during the evaluation.
  LearningSink(const mapper::Optimizer& optimizer, map::GaussianStore& store,
               map::MeanBounds& bounds, GaussianNotes& notes, LearnedHarmonics& harmonics,
               const PinholeCamera& camera, const SE3& T_world_camera, double least_sigma_px);
  void accept(std::span<const std::uint32_t> indices, const map::Gaussian* rows) override;

 private:
  void step_harmonics(std::span<const std::uint32_t> indices, const map::Gaussian* rows);
  void note(std::uint32_t index, const map::Gaussian& row);
  void keep_thick(std::uint32_t index);

  const mapper::Optimizer& optimizer_;
  map::GaussianStore& store_;
  map::MeanBounds& bounds_;
  GaussianNotes& notes_;
  LearnedHarmonics& harmonics_;
  Eigen::Vector3d center_;
  float pixel_at_1m_;       // extent of a pixel, metres
  float axis_[3], offset_;  // depth of a point: axis . p + offset
  float least_log_sigma_;   // in pixels
};

}  // namespace sgs::refine
