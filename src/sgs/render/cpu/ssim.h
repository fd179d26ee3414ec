// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "sgs/core/thread_pool.h"

namespace sgs::render::cpu {

/// The window's weights from its centre outwards.
struct SsimTaps {
  float w[6];
};

/// One row-major channel whose rows are padded to a multiple of 16 floats, with a frame of zeros
/// around it that the 11x11 window may read.
struct PaddedPlane {
  static constexpr int kRadius = 5, kMargin = 16;  // columns: whole vectors; rows: kRadius

  int width = 0, height = 0, stride = 0;
  std::vector<float> data;

  PaddedPlane() = default;
  PaddedPlane(int w, int h)
      : width(w),
        height(h),
        stride((w + 15) / 16 * 16 + 2 * kMargin),
        data(static_cast<std::size_t>(stride) * static_cast<std::size_t>(h + 2 * kRadius), 0.0f) {}
  float* row(int y) {
    return data.data() + static_cast<std::size_t>(y + kRadius) * static_cast<std::size_t>(stride) +
           kMargin;
  }
  const float* row(int y) const {
    return data.data() + static_cast<std::size_t>(y + kRadius) * static_cast<std::size_t>(stride) +
           kMargin;
  }
};

/// Window moments of a measured channel, which never change.
struct MeasuredMoments {
  PaddedPlane y, mean, variance;
  explicit MeasuredMoments(PaddedPlane channel);
  MeasuredMoments() = default;
};

/// Sum of (1 - SSIM) over an image, and its gradient: SSIM of Wang et al. 2004 with the usual
/// 11x11 Gaussian window (sigma 1.5), separable, zero-padded.
class Dssim {
 public:
  /// `x` is the rendered channel; the gradient with respect to it goes to `gradient` (same size).
  double evaluate(const PaddedPlane& x, const MeasuredMoments& measured, PaddedPlane& gradient,
                  ThreadPool& pool);

 private:
  void reserve(int width, int height);
  PaddedPlane rows_[3], derivative_[3];
  std::vector<double> band_values_;
};

}  // namespace sgs::render::cpu
