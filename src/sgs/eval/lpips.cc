// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/eval/lpips.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "sgs/eval/conv.h"
#include "sgs/io/atomic_file.h"

namespace sgs::eval {
namespace {

static_assert(std::endian::native == std::endian::little, "weights are read as they lie on disk");

struct LayerShape {
  int outputs, inputs, kernel, stride, padding;
  bool pool_before;
};
/// The convolutions of torchvision's AlexNet.
constexpr std::array<LayerShape, 5> kShapes = {{{64, 3, 11, 4, 2, false},
                                                {192, 64, 5, 1, 2, true},
                                                {384, 192, 3, 1, 1, true},
                                                {256, 384, 3, 1, 1, false},
                                                {256, 256, 3, 1, 1, false}}};

constexpr std::size_t weight_count(const LayerShape& s) {
  return static_cast<std::size_t>(s.outputs) * static_cast<std::size_t>(s.inputs) *
         static_cast<std::size_t>(s.kernel) * static_cast<std::size_t>(s.kernel);
}

constexpr std::size_t total_floats() {
  std::size_t n = 0;
  for (const LayerShape& s : kShapes)
    n += weight_count(s) + 2 * static_cast<std::size_t>(s.outputs);
  return n;
}
static_assert(total_floats() == 2470848);

/// The network's input: RGB in [-1, 1], shifted and scaled by LPIPS' constants.
FeatureMap network_input(const ColorFloatImage& image) {
  constexpr std::array<float, 3> kShift = {-.030f, -.088f, -.188f}, kScale = {.458f, .448f, .450f};
  FeatureMap map{3, image.width(), image.height(), std::vector<float>(3 * image.size())};
  for (std::size_t i = 0; i < image.size(); ++i) {
    const render::Rgbf& p = image.data()[i];
    const std::array<float, 3> rgb = {p.r, p.g, p.b};
    for (std::size_t c = 0; c < 3; ++c) {
      map.values[c * image.size() + i] = (2 * rgb[c] - 1 - kShift[c]) / kScale[c];
    }
  }
  return map;
}

LpipsFeatures::Layer unit_length(const FeatureMap& map) {
  const auto pixels = static_cast<std::size_t>(map.width) * static_cast<std::size_t>(map.height);
  std::vector<float> norm(pixels, 0.0f);
  for (std::size_t i = 0; i < map.values.size(); i += pixels) {
    for (std::size_t p = 0; p < pixels; ++p) norm[p] += map.values[i + p] * map.values[i + p];
  }
  for (float& n : norm) n = 1.0f / (std::sqrt(n) + 1e-10f);
  LpipsFeatures::Layer layer{map.channels, map.width, map.height, map.values};
  for (std::size_t i = 0; i < layer.values.size(); i += pixels) {
    for (std::size_t p = 0; p < pixels; ++p) layer.values[i + p] *= norm[p];
  }
  return layer;
}

}  // namespace

struct Lpips::Weights {
  std::array<ConvLayer, 5> conv;
  std::array<std::vector<float>, 5> linear;
};

Result<Lpips> Lpips::load(const std::filesystem::path& path) {
  SGS_ASSIGN_OR_RETURN(const std::string bytes, io::read_file(path));
  constexpr std::size_t kBytes = sizeof(float) * total_floats();
  if (bytes.size() != kBytes) {
    return fail(ErrorCode::kInvalidFormat,
                fmt::format("{}: {} bytes where the LPIPS-Alex v0.1 weights have {}", path.string(),
                            bytes.size(), kBytes),
                "give the complete file of little-endian float32 tensors");
  }
  std::vector<float> values(total_floats());
  std::memcpy(values.data(), bytes.data(), bytes.size());
  if (!std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); })) {
    return fail(ErrorCode::kInvalidFormat,
                fmt::format("{}: weights that are not finite", path.string()),
                "the file is damaged; fetch it again");
  }
  auto weights = std::make_shared<Weights>();
  const float* next = values.data();
  for (std::size_t i = 0; i < kShapes.size(); ++i) {
    const LayerShape& s = kShapes[i];
    const float* bias = next + weight_count(s);
    weights->conv[i] = pack_conv(next, bias, s.outputs, s.inputs, s.kernel, s.stride, s.padding);
    next = bias + s.outputs;
  }
  for (std::size_t i = 0; i < kShapes.size(); ++i) {
    weights->linear[i].assign(next, next + kShapes[i].outputs);
    next += kShapes[i].outputs;
  }
  return Lpips(std::move(weights));
}

std::optional<LpipsFeatures> Lpips::features(const ColorFloatImage& image) const {
  if (image.width() < kMinSize_px || image.height() < kMinSize_px) return std::nullopt;
  LpipsFeatures result;
  FeatureMap map = network_input(image);
  for (std::size_t i = 0; i < kShapes.size(); ++i) {
    if (kShapes[i].pool_before) map = max_pool(map);
    map = conv_relu(map, weights_->conv[i]);
    result.layers[i] = unit_length(map);
  }
  return result;
}

double Lpips::distance(const LpipsFeatures& a, const LpipsFeatures& b) const {
  double total = 0;
  for (std::size_t i = 0; i < a.layers.size(); ++i) {
    const LpipsFeatures::Layer &x = a.layers[i], &y = b.layers[i];
    SGS_CHECK(x.width == y.width && x.height == y.height, "pictures differ in size");
    const auto pixels = static_cast<std::size_t>(x.width) * static_cast<std::size_t>(x.height);
    double layer = 0;
    for (std::size_t c = 0; c < static_cast<std::size_t>(x.channels); ++c) {
      double sum = 0;
      for (std::size_t p = c * pixels; p < (c + 1) * pixels; ++p) {
        const float d = x.values[p] - y.values[p];
        sum += static_cast<double>(d * d);
      }
      layer += static_cast<double>(weights_->linear[i][c]) * sum;
    }
    total += layer / static_cast<double>(pixels);
  }
  return total;
}

std::optional<double> Lpips::distance(const ColorFloatImage& a, const ColorFloatImage& b) const {
  SGS_CHECK(a.width() == b.width() && a.height() == b.height(), "pictures differ in size");
  const auto features_a = features(a), features_b = features(b);
  if (!features_a || !features_b) return std::nullopt;
  return distance(*features_a, *features_b);
}

}  // namespace sgs::eval
