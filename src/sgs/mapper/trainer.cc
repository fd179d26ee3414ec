// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapper/trainer.h"

#include "sgs/mapper/keyframe_refinement.h"
#include "sgs/render/pose_information.h"

namespace sgs::mapper {
namespace {

render::LossConfig loss_config(const ObjectiveConfig& objective) {
  render::LossConfig loss;
  loss.color_weight = static_cast<float>(objective.color_weight);
  loss.depth_weight = static_cast<float>(objective.depth_weight);
  loss.color_knee = static_cast<float>(objective.color_knee);
  loss.depth_knee_m = static_cast<float>(objective.depth_knee_m);
  loss.depth_form = objective.depth_form;
  loss.color_only_where_depth = objective.color_only_where_depth;
  loss.floater_margin_m = static_cast<float>(objective.floater_margin_m);
  return loss;
}

double pixels_of(const PinholeCamera& camera) {
  return static_cast<double>(camera.width) * camera.height;
}

}  // namespace

Trainer::Trainer(const ObjectiveConfig& objective, const KeyframeRefinementConfig& refinement)
    : objective_(objective), refinement_(refinement), loss_(loss_config(objective)) {}

void Trainer::begin(const MapKeyframe& keyframe, int level) {
  const bool structural =
      level == 0 && objective_.dssim_weight > 0 && full_steps_++ % objective_.dssim_interval == 0;
  loss_.dssim_weight = structural ? static_cast<float>(objective_.dssim_weight) : 0.0f;
  loss_.gain = keyframe.gain;
}

void Trainer::evaluate(render::Rasterizer& rasterizer, std::span<const map::Gaussian> seen,
                       const MapKeyframe& keyframe, const render::TrainingView& view,
                       const render::EvaluateOptions& options) {
  rasterizer.evaluate(seen, view, keyframe.T_world_camera, loss_, gradients_, options);
  pixels_ = pixels_of(view.camera());
  last_loss_ = gradients_.loss / pixels_;
}

void Trainer::learn_exposure(MapKeyframe& keyframe) const {
  if (!refinement_.exposure) return;
  update_gain(keyframe, gradients_.exposure_measured, gradients_.exposure_rendered,
              refinement_.exposure_prior, refinement_.exposure_step);
}

bool Trainer::learn_pose(MapKeyframe& keyframe) const {
  if (!refinement_.pose || keyframe.visits < refinement_.pose_first_visit) return true;
  if (!keyframe.pose_information) {
    const auto half = keyframe.training_image(1);
    if (!half) return false;
    keyframe.pose_information = std::make_shared<Matrix6d>(render::pose_information(*half, loss_));
  }
  // A step at full resolution sums over four times as many pixels.
  const double pixels = pixels_of(keyframe.camera().halved(1));
  refine_pose(keyframe, (pixels / pixels_) * gradients_.camera_twist, pixels, refinement_);
  return true;
}

}  // namespace sgs::mapper
