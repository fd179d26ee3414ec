// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/eval/lpips.h"

#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "sgs/eval/conv.h"
#include "sgs/io/image_io.h"

namespace sgs::eval {
namespace {

std::filesystem::path weights_folder() {
  const char* shared = std::getenv("SGS_SHARED_DIR");
  const std::filesystem::path root =
      shared != nullptr ? shared : std::filesystem::path(SGS_SOURCE_DIR) / ".." / "shared";
  return root / "weights";
}

/// Deterministic values in [-1, 1].
std::vector<float> values(std::size_t count, unsigned seed) {
  std::vector<float> v(count);
  for (float& x : v) {
    seed = seed * 1664525u + 1013904223u;
    x = static_cast<float>(seed >> 8) / 8388608.0f - 1;
  }
  return v;
}

/// The definition, in double.
double direct(const FeatureMap& in, const std::vector<float>& w, float bias, int o, int x, int y,
              int kernel, int stride, int padding) {
  double sum = bias;
  for (int c = 0; c < in.channels; ++c) {
    for (int ky = 0; ky < kernel; ++ky) {
      for (int kx = 0; kx < kernel; ++kx) {
        const int u = x * stride + kx - padding, v = y * stride + ky - padding;
        if (u < 0 || v < 0 || u >= in.width || v >= in.height) continue;
        const auto wi =
            static_cast<std::size_t>(((o * in.channels + c) * kernel + ky) * kernel + kx);
        const auto vi = static_cast<std::size_t>((c * in.height + v) * in.width + u);
        sum += static_cast<double>(w[wi]) * static_cast<double>(in.values[vi]);
      }
    }
  }
  return std::max(0.0, sum);
}

TEST(Conv, MatchesTheDefinition) {
  struct Case {
    int outputs, inputs, kernel, stride, padding, width, height;
  };
  for (const Case& c :
       {Case{7, 3, 11, 4, 2, 61, 47}, Case{12, 5, 5, 1, 2, 19, 33}, Case{1, 2, 3, 1, 1, 3, 2}}) {
    const FeatureMap in{c.inputs, c.width, c.height,
                        values(static_cast<std::size_t>(c.inputs * c.width * c.height), 1)};
    const auto w = values(static_cast<std::size_t>(c.outputs * c.inputs * c.kernel * c.kernel), 2);
    const auto bias = values(static_cast<std::size_t>(c.outputs), 3);
    const auto out = conv_relu(
        in, pack_conv(w.data(), bias.data(), c.outputs, c.inputs, c.kernel, c.stride, c.padding));
    ASSERT_EQ(out.width, (c.width + 2 * c.padding - c.kernel) / c.stride + 1);
    ASSERT_EQ(out.height, (c.height + 2 * c.padding - c.kernel) / c.stride + 1);
    std::size_t i = 0;
    for (int o = 0; o < c.outputs; ++o) {
      for (int y = 0; y < out.height; ++y) {
        for (int x = 0; x < out.width; ++x, ++i) {
          ASSERT_NEAR(static_cast<double>(out.values[i]),
                      direct(in, w, bias[static_cast<std::size_t>(o)], o, x, y, c.kernel, c.stride,
                             c.padding),
                      1e-4);
        }
      }
    }
  }
}

TEST(Conv, MaxPool) {
  FeatureMap in{1, 5, 4, std::vector<float>(20)};
  for (std::size_t i = 0; i < 20; ++i) in.values[i] = static_cast<float>(i);
  const FeatureMap out = max_pool(in);
  EXPECT_EQ(out.width, 2);
  EXPECT_EQ(out.height, 1);
  EXPECT_THAT(out.values, ::testing::ElementsAre(12.0f, 14.0f));
}

TEST(Lpips, ReferenceValues) {
  const auto folder = weights_folder();
  if (!std::filesystem::exists(folder / "lpips_alex_v0.1.bin")) {
    GTEST_SKIP() << "no LPIPS weights in " << folder;
  }
  const auto lpips = Lpips::load(folder / "lpips_alex_v0.1.bin");
  ASSERT_TRUE(lpips) << lpips.error().text();
  std::ifstream file(folder / "reference_values.txt");
  std::string line;
  int checked = 0;
  while (std::getline(file, line)) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words(line);
    std::string net, a, b;
    double expected = 0;
    ASSERT_TRUE(words >> net >> a >> b >> expected) << line;
    const auto image_a = io::load_color(folder / "reference_images" / a);
    const auto image_b = io::load_color(folder / "reference_images" / b);
    ASSERT_TRUE(image_a && image_b);
    const auto features = lpips->features(to_float(*image_a));
    EXPECT_NEAR(lpips->distance(*features, *lpips->features(to_float(*image_b))), expected, 1e-5);
    EXPECT_NEAR(*lpips->distance(to_float(*image_a), to_float(*image_b)), expected, 1e-5);
    EXPECT_EQ(lpips->distance(*features, *features), 0);
    ++checked;
  }
  EXPECT_EQ(checked, 2);
  EXPECT_TRUE(lpips->features(ColorFloatImage(32, 32)));
  EXPECT_FALSE(lpips->features(ColorFloatImage(31, 640)));
}

TEST(Lpips, BadFilesAreErrorsThatNameThem) {
  EXPECT_FALSE(Lpips::load("/nonexistent/weights.bin"));
  const auto path = std::filesystem::path(::testing::TempDir()) / "sgs_short_weights.bin";
  std::ofstream(path) << "short";
  const auto result = Lpips::load(path);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::kInvalidFormat);
  EXPECT_THAT(result.error().message, ::testing::HasSubstr("sgs_short_weights.bin"));
  EXPECT_THAT(result.error().message, ::testing::HasSubstr("9883392"));
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace sgs::eval
