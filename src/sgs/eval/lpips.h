// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "sgs/core/error.h"
#include "sgs/eval/image_metrics.h"

namespace sgs::eval {

/// Features of one image, unit length along the channels, for comparing it with several others.
struct LpipsFeatures {
  struct Layer {
    int channels = 0, width = 0, height = 0;
    std::vector<float> values;  ///< channel-major
  };
  std::array<Layer, 5> layers;
};

/// Learned perceptual image patch similarity, AlexNet, version 0.1 (Zhang et al., CVPR 2018).
/// Immutable after loading and thread-safe. Values are the same for any number of threads; across
/// processors they agree to about 1e-5.
class Lpips {
 public:
  /// Smallest width and height that reach the last layer.
  static constexpr int kMinSize_px = 32;

  /// Reads the weights: little-endian float32 tensors in the order features.{0,3,6,8,10}.weight
  /// (OIHW) and .bias, lin{0..4}.weight; 9,883,392 bytes. A missing file, another size and values
  /// that are not finite are errors.
  static Result<Lpips> load(const std::filesystem::path& path);

  /// Features of an RGB image in [0, 1]; empty for images smaller than kMinSize_px.
  std::optional<LpipsFeatures> features(const ColorFloatImage& image) const;
  /// Distance of two images of equal size: 0 = the same.
  double distance(const LpipsFeatures& a, const LpipsFeatures& b) const;
  std::optional<double> distance(const ColorFloatImage& a, const ColorFloatImage& b) const;

 private:
  struct Weights;
  explicit Lpips(std::shared_ptr<const Weights> weights) : weights_(std::move(weights)) {}
  std::shared_ptr<const Weights> weights_;
};

}  // namespace sgs::eval
