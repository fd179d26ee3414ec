// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "sgs/core/enum_names.h"

namespace sgs::render {

/// What the depth loss compares; see LossConfig.
enum class DepthForm { kAlphaRelative, kAbsolute };

constexpr auto enum_names(DepthForm) {
  using enum DepthForm;
  return std::to_array<EnumName<DepthForm>>(
      {{kAlphaRelative, "alpha_relative"}, {kAbsolute, "absolute"}});
}

/// The loss of a training view, summed over pixels (not averaged):
///   color_weight / 3 * sum_c |gain_c r_c - y_c|   over all pixels (or those with depth, see below)
/// + depth_weight * |D - A z| / max(z, 0.3 m)       over pixels with measured depth z
/// (kAlphaRelative), or
///   depth_weight * |D - z|                         (kAbsolute: the paper's form)
/// + dssim_weight * (1 - SSIM) averaged over channels, over all pixels (0 = off), SSIM between
///   gain_c r_c and y_c in an 11x11 Gaussian window (sigma 1.5) on zero-padded images.
/// Where |e| is below a knee k it is replaced by its Huber form, e^2 / 2k (and |e| - k/2 above): an
/// L1 slope that does not shrink with the residual keeps Adam's steps from settling.
struct LossConfig {
  float color_weight = 0.8f;
  float color_knee = 0.0f;  ///< 0 = L1
  float depth_weight = 0.2f;
  float depth_knee_m = 0.0f;
  float dssim_weight = 0.0f;
  DepthForm depth_form = DepthForm::kAlphaRelative;
  bool color_only_where_depth = false;  ///< paper: pixels without depth count nothing
  /// Gaussians more than this far in front of the measured depth get no gradient (paper's
  /// "floaters"); 0 = off.
  float floater_margin_m = 0.0f;
  std::array<float, 3> gain = {1, 1, 1};  ///< exposure gain of this view per channel
};

}  // namespace sgs::render
