// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "mapping_loop.h"

namespace sgs::benchmarks {
namespace {

mapper::OptimizerConfig tiny_steps() {
  mapper::OptimizerConfig config;
  for (double* rate : {&config.rate_mean_m, &config.rate_log_scale, &config.rate_rotation,
                       &config.rate_opacity, &config.rate_color}) {
    *rate = 1e-9;
  }
  // Computed, but without effect on this scene's random shapes.
  config.max_axis_ratio = config.max_flatness = 1000;
  return config;
}

}  // namespace

MappingLoop::MappingLoop(const MappingLoopOptions& options)
    : pool_(options.threads),
      rasterizer_(render::make_cpu_rasterizer(&pool_)),
      optimizer_(tiny_steps()),
      pose_(room_pose()) {
  const auto gaussians = options.dense ? make_view_filling(options.gaussians, options.sigma)
                                       : make_room(options.gaussians, options.sigma);
  constexpr float kNoLimit = 1e6f;
  mapper::reserve(store_, gaussians.size());
  for (const map::Gaussian& g : gaussians) store_.append(g, {}, kNoLimit);
  bounds_.assign(store_.raw, store_.average);
  training_ = rasterizer_->prepare(
      disturbed_view(*rasterizer_, gaussians, room_camera(options.width), pose_));
  loss_.dssim_weight = options.dssim_weight;
}

void MappingLoop::iterate() {
  mapper::StepWithBackward step(optimizer_, store_, bounds_);
  rasterizer_->evaluate(store_.raw, *training_, pose_, loss_, gradients_,
                        {.scope = {.bounds = &bounds_}, .sink = &step});
}

std::size_t MappingLoop::visible() const { return gradients_.visible.size(); }

}  // namespace sgs::benchmarks
