// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include "sgs/core/image.h"
#include "sgs/render/rasterizer.h"

namespace sgs::eval {

/// RGB image with values in [0, 1]: what all picture metrics take. Pairs must have equal sizes.
using ColorFloatImage = Image<render::Rgbf>;

/// 8-bit colour divided by 255.
ColorFloatImage to_float(const ColorImage& image);
/// A rendering's colour clamped to [0, 1]; values that are not finite become 0.
ColorFloatImage clamped(const ColorFloatImage& image);
/// The image with its channels times `gain`.
ColorFloatImage brightened(const ColorFloatImage& image, const std::array<float, 3>& gain);
/// The image with black where `depth` is 0: the `gsicp` rule applies it to truth and rendering.
ColorFloatImage zero_without_depth(const ColorFloatImage& image, const DepthImage& depth);

/// Upper end of psnr_db(); identical images give this instead of infinity.
inline constexpr double kMaxPsnr_db = 100;
/// Peak signal-to-noise ratio in dB, peak 1, mean squared error over all channels and all pixels
/// that are `seen` (null: all; 0 dB where none is).
double psnr_db(const ColorFloatImage& truth, const ColorFloatImage& image,
               const PixelMask* seen = nullptr);
/// The image with black where the camera saw nothing (null: it saw all).
ColorFloatImage zero_unseen(const ColorFloatImage& image, const PixelMask* seen);

/// Structural similarity (Wang et al., TIP 2004): 11x11 Gaussian window of sigma 1.5, K1 = 0.01,
/// K2 = 0.03, range 1, per channel, mean over channels. As scikit-image's structural_similarity
/// with gaussian_weights=True, sigma=1.5, use_sample_covariance=False, data_range=1: the mean is
/// over the interior, where the window lies wholly inside the image (5 pixels off each border), so
/// no border rule plays a part. Pixels that are not `seen` (null: all are) are black in both, and
/// windows that hold nothing else do not count. Empty for images smaller than 11x11.
std::optional<double> ssim(const ColorFloatImage& truth, const ColorFloatImage& image,
                           const PixelMask* seen = nullptr);

/// Mean |D / A - z| over pixels with measured depth z > 0 and A >= `min_alpha`.
struct DepthError {
  double l1_m = 0;
  double coverage = 0;  ///< share of the pixels with measured depth that were compared
};
/// Empty where nothing can be compared.
std::optional<DepthError> depth_error(const DepthImage& measured,
                                      const render::Rendering& rendering, float min_alpha = 0.5f);

}  // namespace sgs::eval
