// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "sgs/core/archive.h"
#include "sgs/map/gaussian.h"
#include "sgs/mapper/keyframe.h"
#include "sgs/mapper/mapper_config.h"
#include "sgs/render/rasterizer.h"

namespace sgs::mapper {

/// One step of learning a map: the Gaussians from one view, and that view's exposure and pose from
/// the Gaussians. While the map grows and when it is finished alike; who calls it decides which
/// view comes next, and what a sink does with the gradients.
class Trainer {
 public:
  Trainer(const ObjectiveConfig& objective, const KeyframeRefinementConfig& refinement);

  /// Loss of the next step from this keyframe at full resolution (level 0) or half of it (1).
  void begin(const MapKeyframe& keyframe, int level);
  /// The step: evaluates `seen` against `view`, which is of `keyframe`, from the keyframe's pose.
  void evaluate(render::Rasterizer& rasterizer, std::span<const map::Gaussian> seen,
                const MapKeyframe& keyframe, const render::TrainingView& view,
                const render::EvaluateOptions& options);
  /// Moves the keyframe's gains by what the step has shown (KeyframeRefinementConfig::exposure).
  void learn_exposure(MapKeyframe& keyframe) const;
  /// Moves its pose (KeyframeRefinementConfig::pose), if it has been visited often enough. False
  /// where its pictures are gone.
  bool learn_pose(MapKeyframe& keyframe) const;
  /// Loss per pixel of the last step.
  double last_loss() const { return last_loss_; }
  bool consistent() const { return full_steps_ >= 0; }

  template <class Archive>
  void archive(Archive& a) {
    a(full_steps_, last_loss_);
  }

 private:
  ObjectiveConfig objective_;
  KeyframeRefinementConfig refinement_;
  render::LossConfig loss_;
  render::Gradients gradients_;
  double pixels_ = 0;  // of the last step's view
  std::int64_t full_steps_ = 0;
  double last_loss_ = 0;
};

}  // namespace sgs::mapper
