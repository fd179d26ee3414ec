// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sgs/eval/conv.cc"
#include "hwy/foreach_target.h"
// foreach_target.h must come first: it includes this file once per instruction set.
#include <algorithm>
#include <cstring>

#include "hwy/highway.h"
#include "sgs/core/error.h"
#include "sgs/eval/conv.h"

HWY_BEFORE_NAMESPACE();
namespace sgs::eval {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Outputs per group: six rows of two vectors keep twelve accumulators in registers.
constexpr int kRows = 6;

int panel_width() { return 2 * static_cast<int>(hn::Lanes(hn::ScalableTag<float>())); }

/// tile[r][c] = sum_k weights[k][r] * panel[k][c] for kRows rows and one panel of columns.
void multiply_panel(const float* HWY_RESTRICT weights, const float* HWY_RESTRICT panel, int depth,
                    float* HWY_RESTRICT tile) {
  const hn::ScalableTag<float> d;
  const std::size_t lanes = hn::Lanes(d);
  using V = hn::Vec<decltype(d)>;
  V a0 = hn::Zero(d), a1 = a0, b0 = a0, b1 = a0, c0 = a0, c1 = a0;
  V d0 = a0, d1 = a0, e0 = a0, e1 = a0, f0 = a0, f1 = a0;
  for (int k = 0; k < depth; ++k) {
    const V x0 = hn::LoadU(d, panel), x1 = hn::LoadU(d, panel + lanes);
    V w = hn::Set(d, weights[0]);
    a0 = hn::MulAdd(w, x0, a0);
    a1 = hn::MulAdd(w, x1, a1);
    w = hn::Set(d, weights[1]);
    b0 = hn::MulAdd(w, x0, b0);
    b1 = hn::MulAdd(w, x1, b1);
    w = hn::Set(d, weights[2]);
    c0 = hn::MulAdd(w, x0, c0);
    c1 = hn::MulAdd(w, x1, c1);
    w = hn::Set(d, weights[3]);
    d0 = hn::MulAdd(w, x0, d0);
    d1 = hn::MulAdd(w, x1, d1);
    w = hn::Set(d, weights[4]);
    e0 = hn::MulAdd(w, x0, e0);
    e1 = hn::MulAdd(w, x1, e1);
    w = hn::Set(d, weights[5]);
    f0 = hn::MulAdd(w, x0, f0);
    f1 = hn::MulAdd(w, x1, f1);
    weights += kRows;
    panel += 2 * lanes;
  }
  const V rows[kRows][2] = {{a0, a1}, {b0, b1}, {c0, c1}, {d0, d1}, {e0, e1}, {f0, f1}};
  for (const auto& row : rows) {
    hn::StoreU(row[0], d, tile);
    hn::StoreU(row[1], d, tile + lanes);
    tile += 2 * lanes;
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace sgs::eval
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sgs::eval {
HWY_EXPORT(panel_width);
HWY_EXPORT(multiply_panel);

namespace {

constexpr int kGroup = 6;
/// Panels multiplied with one group of weights while that group is in the nearest cache.
constexpr int kPanelsPerBlock = 4;

/// The input with its zero border, and where each tap and each output pixel start in it.
struct PaddedInput {
  std::vector<float> values;
  std::vector<std::size_t> tap_offset;
  int width = 0, stride = 1, output_width = 0;

  PaddedInput(const FeatureMap& input, const ConvLayer& layer)
      : width(input.width + 2 * layer.padding), stride(layer.stride) {
    const int height = input.height + 2 * layer.padding;
    const auto plane = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    values.assign(plane * static_cast<std::size_t>(input.channels), 0.0f);
    for (int c = 0; c < input.channels; ++c) {
      for (int y = 0; y < input.height; ++y) {
        const float* row =
            input.values.data() + (static_cast<std::size_t>(c) * input.height + y) * input.width;
        std::copy(row, row + input.width,
                  values.data() + c * plane + static_cast<std::size_t>(y + layer.padding) * width +
                      layer.padding);
      }
      for (int ky = 0; ky < layer.kernel; ++ky) {
        for (int kx = 0; kx < layer.kernel; ++kx) {
          tap_offset.push_back(c * plane + static_cast<std::size_t>(ky) * width + kx);
        }
      }
    }
    output_width = (width - layer.kernel) / stride + 1;
  }

  std::size_t pixel_offset(int pixel) const {
    return static_cast<std::size_t>(pixel / output_width) * stride * width +
           static_cast<std::size_t>(pixel % output_width) * stride;
  }
};

/// Columns of the patch matrix for `count` output pixels from `first` on, tap-major, `width` wide.
void pack_panel(const PaddedInput& input, int first, int count, int width, float* panel) {
  std::vector<std::size_t> base(static_cast<std::size_t>(width));
  for (int j = 0; j < width; ++j) {
    base[static_cast<std::size_t>(j)] = input.pixel_offset(first + std::min(j, count - 1));
  }
  const bool contiguous = base.back() - base.front() == static_cast<std::size_t>(width - 1);
  for (const std::size_t tap : input.tap_offset) {
    const float* source = input.values.data() + tap;
    if (contiguous) {
      std::memcpy(panel, source + base[0], sizeof(float) * base.size());
    } else {
      for (std::size_t j = 0; j < base.size(); ++j) panel[j] = source[base[j]];
    }
    panel += width;
  }
}

/// Adds bias, applies ReLU and writes one tile into the output.
void store_tile(const float* tile, int width, int first, int count, int first_output,
                const ConvLayer& layer, FeatureMap& out) {
  const auto pixels = static_cast<std::size_t>(out.width) * static_cast<std::size_t>(out.height);
  for (int r = 0; r < std::min(kGroup, layer.outputs - first_output); ++r) {
    const auto o = static_cast<std::size_t>(first_output + r);
    float* target = out.values.data() + o * pixels + first;
    for (int j = 0; j < count; ++j) target[j] = std::max(0.0f, tile[r * width + j] + layer.bias[o]);
  }
}

}  // namespace

ConvLayer pack_conv(const float* weights_oihw, const float* bias, int outputs, int inputs,
                    int kernel, int stride, int padding) {
  ConvLayer layer{inputs, outputs, kernel, stride, padding, {}, {bias, bias + outputs}};
  const auto taps = static_cast<std::size_t>(inputs) * kernel * kernel;
  const int groups = (outputs + kGroup - 1) / kGroup;
  layer.packed.assign(static_cast<std::size_t>(groups) * kGroup * taps, 0.0f);
  for (int o = 0; o < outputs; ++o) {
    float* group = layer.packed.data() + static_cast<std::size_t>(o / kGroup) * kGroup * taps;
    for (std::size_t k = 0; k < taps; ++k) {
      group[k * kGroup + static_cast<std::size_t>(o % kGroup)] =
          weights_oihw[static_cast<std::size_t>(o) * taps + k];
    }
  }
  return layer;
}

FeatureMap conv_relu(const FeatureMap& input, const ConvLayer& layer) {
  SGS_CHECK(input.channels == layer.inputs, "channels of the layer");
  SGS_CHECK(std::min(input.width, input.height) + 2 * layer.padding >= layer.kernel,
            "input smaller than the kernel");
  const PaddedInput padded(input, layer);
  FeatureMap out;
  out.channels = layer.outputs;
  out.width = padded.output_width;
  out.height = (input.height + 2 * layer.padding - layer.kernel) / layer.stride + 1;
  const int pixels = out.width * out.height;
  out.values.resize(static_cast<std::size_t>(pixels) * layer.outputs);
  const int width = HWY_DYNAMIC_DISPATCH(panel_width)();
  const int taps = static_cast<int>(padded.tap_offset.size());
  const std::size_t panel_size = static_cast<std::size_t>(taps) * width;
  std::vector<float> panels(panel_size * kPanelsPerBlock);
  std::vector<float> tile(static_cast<std::size_t>(kGroup) * width);
  const int block = width * kPanelsPerBlock;
  for (int first = 0; first < pixels; first += block) {
    const int used = (std::min(block, pixels - first) + width - 1) / width;
    for (int p = 0; p < used; ++p) {
      const int start = first + p * width;
      pack_panel(padded, start, std::min(width, pixels - start), width,
                 panels.data() + panel_size * p);
    }
    for (int o = 0; o < layer.outputs; o += kGroup) {
      const float* group = layer.packed.data() + static_cast<std::size_t>(o) * taps;
      for (int p = 0; p < used; ++p) {
        const int start = first + p * width;
        HWY_DYNAMIC_DISPATCH(multiply_panel)
        (group, panels.data() + panel_size * p, taps, tile.data());
        store_tile(tile.data(), width, start, std::min(width, pixels - start), o, layer, out);
      }
    }
  }
  return out;
}

FeatureMap max_pool(const FeatureMap& input) {
  FeatureMap out;
  out.channels = input.channels;
  out.width = (input.width - 3) / 2 + 1;
  out.height = (input.height - 3) / 2 + 1;
  SGS_CHECK(input.width >= 3 && input.height >= 3, "input smaller than the pooling window");
  out.values.reserve(static_cast<std::size_t>(out.channels) * out.width * out.height);
  for (int c = 0; c < out.channels; ++c) {
    const float* plane =
        input.values.data() + static_cast<std::size_t>(c) * input.width * input.height;
    for (int y = 0; y < out.height; ++y) {
      for (int x = 0; x < out.width; ++x) {
        const float* corner = plane + static_cast<std::size_t>(2 * y) * input.width + 2 * x;
        float best = corner[0];
        for (int i = 0; i < 9; ++i) {
          best = std::max(best, corner[static_cast<std::size_t>(i / 3) * input.width + i % 3]);
        }
        out.values.push_back(best);
      }
    }
  }
  return out;
}

}  // namespace sgs::eval
#endif  // HWY_ONCE
