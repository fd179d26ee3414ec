// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

namespace sgs::eval {

/// Layers of a small convolutional network on channel-major float images, vectorised with run-time
/// dispatch. Single-threaded; every output is summed in the same order whatever the caller's
/// threads.

/// Channel-major image.
struct FeatureMap {
  int channels = 0, width = 0, height = 0;
  std::vector<float> values;
};

/// Weights of one convolution, packed for the kernel.
struct ConvLayer {
  int inputs = 0, outputs = 0, kernel = 0, stride = 1, padding = 0;
  std::vector<float> packed;  ///< groups of kGroup outputs, tap-major, zero rows at the end
  std::vector<float> bias;
};

/// Packs weights in OIHW order.
ConvLayer pack_conv(const float* weights_oihw, const float* bias, int outputs, int inputs,
                    int kernel, int stride, int padding);

/// Convolution (zero padding), bias, ReLU.
FeatureMap conv_relu(const FeatureMap& input, const ConvLayer& layer);

/// 3x3 maximum with stride 2, no padding.
FeatureMap max_pool(const FeatureMap& input);

}  // namespace sgs::eval
