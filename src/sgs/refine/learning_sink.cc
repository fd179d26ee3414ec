// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/refine/learning_sink.h"

#include <algorithm>
#include <cmath>

#include "sgs/render/view_color.h"

namespace sgs::refine {

LearningSink::LearningSink(const mapper::Optimizer& optimizer, map::GaussianStore& store,
                           map::MeanBounds& bounds, GaussianNotes& notes,
                           LearnedHarmonics& harmonics, const PinholeCamera& camera,
                           const SE3& T_world_camera, double least_sigma_px)
    : optimizer_(optimizer),
      store_(store),
      bounds_(bounds),
      notes_(notes),
      harmonics_(harmonics),
      center_(T_world_camera.t),
      pixel_at_1m_(static_cast<float>(2 / (camera.fx + camera.fy))),
      least_log_sigma_(static_cast<float>(std::log(std::max(least_sigma_px, 1e-6)))) {
  const Eigen::Vector3d axis = T_world_camera.R.col(2);
  for (int k = 0; k < 3; ++k) axis_[k] = static_cast<float>(axis[k]);
  offset_ = static_cast<float>(-axis.dot(T_world_camera.t));
}

void LearningSink::accept(std::span<const std::uint32_t> indices, const map::Gaussian* rows) {
  for (std::size_t k = 0; k < indices.size(); ++k) note(indices[k], rows[k]);
  if (harmonics_.empty()) {
    optimizer_.step(indices, rows, store_);
  } else {
    step_harmonics(indices, rows);
  }
  for (const std::uint32_t i : indices) {
    keep_thick(i);
    bounds_.widen(i, store_.raw[i]);
  }
}

/// Steps the Gaussians, too: the direction of a colour turns as its mean moves.
void LearningSink::step_harmonics(std::span<const std::uint32_t> indices,
                                  const map::Gaussian* rows) {
  std::vector<map::Gaussian> with_turn(rows, rows + indices.size());
  std::vector<float> gradient(harmonics_.values().floats());
  for (std::size_t k = 0; k < indices.size(); ++k) {
    const std::uint32_t i = indices[k];
    render::color_backward(store_.raw[i], harmonics_.values().of(i), harmonics_.degree(), center_,
                           with_turn[k], gradient);
    harmonics_.step(i, store_.steps[i] + 1, gradient);
  }
  optimizer_.step(indices, with_turn.data(), store_);
}

void LearningSink::note(std::uint32_t index, const map::Gaussian& row) {
  const float* g = row.mean;
  const float pull = std::sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
  if (!(pull > 0)) return;  // hidden, or out of the picture
  const float* m = store_.raw[index].mean;
  const float z = axis_[0] * m[0] + axis_[1] * m[1] + axis_[2] * m[2] + offset_;
  const float pixel_m = pixel_at_1m_ * z;
  notes_.pull[index] += pull * pixel_m;
  notes_.pixel_m[index] = std::min(notes_.pixel_m[index], pixel_m);
}

void LearningSink::keep_thick(std::uint32_t index) {
  const float pixel_m = notes_.pixel_m[index];
  if (pixel_m >= kNeverSeen) return;
  const float least = std::log(pixel_m) + least_log_sigma_;
  for (float& s : store_.raw[index].log_scale) s = std::max(s, least);
}

}  // namespace sgs::refine
