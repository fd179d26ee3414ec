// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/eval/image_metrics.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "sgs/camera/heldout.h"

namespace sgs::eval {
namespace {

struct Pair {
  ColorFloatImage truth, image;
};

/// Integer patterns that Python reproduces exactly.
Pair formula_pair(int width, int height) {
  Pair p{ColorFloatImage(width, height), ColorFloatImage(width, height)};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      float* a = &p.truth(x, y).r;
      float* b = &p.image(x, y).r;
      for (int c = 0; c < 3; ++c) {
        const int base = x * 7 + y * 13 + c * 29 + (x * y) % 11;
        a[c] = static_cast<float>((base % 97) / 96.0);
        b[c] = static_cast<float>(((base + (x * 3 + y * 5) % 17) % 97) / 96.0 * 0.9 + 0.03);
      }
    }
  }
  return p;
}

/// Smooth, low-contrast pictures: the variances are small differences of large moments.
Pair smooth_pair(int width, int height) {
  Pair p{ColorFloatImage(width, height), ColorFloatImage(width, height)};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float v = 0.8f + 0.05f * std::sin(0.05f * static_cast<float>(x + y));
      p.truth(x, y) = {v, 0.9f * v, 0.5f};
      p.image(x, y) = {v + 0.01f * std::sin(0.9f * static_cast<float>(x)), 0.9f * v, 0.51f};
    }
  }
  return p;
}

TEST(Psnr, ByHand) {
  const ColorFloatImage black(4, 4), grey(4, 4, {0.1f, 0.1f, 0.1f});
  EXPECT_NEAR(psnr_db(black, grey), 20, 1e-5);
  EXPECT_NEAR(psnr_db(black, ColorFloatImage(4, 4, {0.1f, 0, 0})), 20 + 10 * std::log10(3), 1e-5);
  EXPECT_EQ(psnr_db(grey, grey), kMaxPsnr_db);
  EXPECT_THROW(psnr_db(black, ColorFloatImage(3, 4)), ContractViolation);
}

TEST(Ssim, FixedValuesOfScikitImage) {
  // scikit-image 0.19.3 on the same formula.
  const Pair p = formula_pair(41, 33);
  EXPECT_NEAR(*ssim(p.truth, p.image), 0.5551693784, 1e-7);
  EXPECT_NEAR(psnr_db(p.truth, p.image), 11.662002097, 1e-5);
}

TEST(Ssim, Extremes) {
  const Pair p = formula_pair(41, 33);
  EXPECT_NEAR(*ssim(p.truth, p.truth), 1, 1e-6);
  EXPECT_FALSE(ssim(ColorFloatImage(10, 40), ColorFloatImage(10, 40)));
  EXPECT_TRUE(ssim(ColorFloatImage(11, 11), ColorFloatImage(11, 11)));
}

void write_floats(const std::filesystem::path& path, const ColorFloatImage& image) {
  std::ofstream out(path, std::ios::binary);
  for (std::size_t i = 0; i < image.size(); ++i) {
    const render::Rgbf& p = image.data()[i];
    for (const float v : {p.r, p.g, p.b}) {
      out.write(reinterpret_cast<const char*>(&v), sizeof v);
    }
  }
}

TEST(Ssim, AgreesWithScikitImage) {
  if (std::system("/usr/bin/python3 -c 'import skimage.metrics' >/dev/null 2>&1") != 0) {
    GTEST_SKIP() << "/usr/bin/python3 with skimage is not installed";
  }
  const auto folder =
      std::filesystem::temp_directory_path() / ("sgs_eval_ssim_" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "compare.py") << R"(
import sys, numpy as np
from skimage.metrics import structural_similarity, peak_signal_noise_ratio
w, h = int(sys.argv[2]), int(sys.argv[3])
a, b = (np.fromfile(sys.argv[1] + n, np.float32).reshape(h, w, 3).astype(float) for n in ("/a", "/b"))
print(structural_similarity(a, b, channel_axis=2, gaussian_weights=True, sigma=1.5,
                            use_sample_covariance=False, data_range=1.0),
      peak_signal_noise_ratio(a, b, data_range=1.0))
)";
  for (const Pair& p : {formula_pair(64, 48), formula_pair(23, 90), smooth_pair(120, 80)}) {
    write_floats(folder / "a", p.truth);
    write_floats(folder / "b", p.image);
    const std::string command = fmt::format("/usr/bin/python3 {0}/compare.py {0} {1} {2}",
                                            folder.string(), p.truth.width(), p.truth.height());
    FILE* pipe = ::popen(command.c_str(), "r");
    ASSERT_NE(pipe, nullptr);
    double expected_ssim = -1, expected_psnr = -1;
    const int read = std::fscanf(pipe, "%lf %lf", &expected_ssim, &expected_psnr);
    ::pclose(pipe);
    ASSERT_EQ(read, 2);
    EXPECT_NEAR(*ssim(p.truth, p.image), expected_ssim, 1e-8);
    EXPECT_NEAR(psnr_db(p.truth, p.image), expected_psnr, 1e-5);
  }
  std::filesystem::remove_all(folder);
}

TEST(Masks, PixelsWithoutDepthBecomeBlackAndStillCount) {
  ColorFloatImage truth(2, 1, {0.5f, 0.5f, 0.5f}), image(2, 1, {0.6f, 0.6f, 0.6f});
  DepthImage depth(2, 1, 1.0f);
  depth(1, 0) = 0;
  const auto a = zero_without_depth(truth, depth), b = zero_without_depth(image, depth);
  EXPECT_EQ(a(1, 0).g, 0);
  EXPECT_EQ(a(0, 0).g, 0.5f);
  EXPECT_NEAR(psnr_db(a, b) - psnr_db(truth, image), 10 * std::log10(2), 1e-4);
}

TEST(Masks, HeldOutFrames) {
  EXPECT_TRUE(is_heldout(4));
  EXPECT_TRUE(is_heldout(12));
  EXPECT_FALSE(is_heldout(0));
  EXPECT_FALSE(is_heldout(8));
  EXPECT_FALSE(is_heldout(4, 0));
  int count = 0;
  for (int i = 0; i < 800; ++i) count += is_heldout(i);
  EXPECT_EQ(count, 100);
}

TEST(DepthError, UsesMeanDepthWhereBothAreKnown) {
  DepthImage measured(4, 1, 2.0f);
  measured(3, 0) = 0;
  render::Rendering r;
  r.depth_sum = Image<float>(4, 1);
  r.alpha = Image<float>(4, 1);
  r.alpha(0, 0) = 0.8f;
  r.depth_sum(0, 0) = 0.8f * 2.1f;  // 0.1 m off
  r.alpha(1, 0) = 1.0f;
  r.depth_sum(1, 0) = 1.7f;  // 0.3 m off
  r.alpha(2, 0) = 0.2f;      // too transparent
  r.alpha(3, 0) = 1.0f;      // not measured
  const auto e = depth_error(measured, r);
  ASSERT_TRUE(e);
  EXPECT_NEAR(e->l1_m, 0.2, 1e-6);
  EXPECT_NEAR(e->coverage, 2.0 / 3, 1e-9);
  EXPECT_FALSE(depth_error(DepthImage(4, 1), r));
}

TEST(Images, ClampedIsFiniteAndInRange) {
  ColorFloatImage image(1, 1, {-1.0f, 2.0f, std::nanf("")});
  const auto p = clamped(image)(0, 0);
  EXPECT_EQ(p.r, 0);
  EXPECT_EQ(p.g, 1);
  EXPECT_EQ(p.b, 0);
}

/// The same pictures with other values where nothing was seen.
Pair with_unseen(Pair p, const PixelMask& seen, float truth, float image) {
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (seen.data()[i] != 0) continue;
    p.truth.data()[i] = {truth, truth, truth};
    p.image.data()[i] = {image, image, image};
  }
  return p;
}

PixelMask left_unseen(int width, int height, int columns) {
  PixelMask seen(width, height, std::uint8_t{1});
  for (int y = 0; y < height; ++y) std::fill_n(seen.row(y), columns, std::uint8_t{0});
  return seen;
}

ColorFloatImage right_part(const ColorFloatImage& image, int from) {
  ColorFloatImage out(image.width() - from, image.height());
  for (int y = 0; y < image.height(); ++y) {
    std::copy_n(image.row(y) + from, out.width(), out.row(y));
  }
  return out;
}

TEST(SeenPixelsOnly, PsnrIsThatOfThePartThatWasSeen) {
  const Pair p = formula_pair(41, 33);
  const PixelMask seen = left_unseen(41, 33, 7);
  const double want = psnr_db(right_part(p.truth, 7), right_part(p.image, 7));
  EXPECT_NEAR(psnr_db(p.truth, p.image, &seen), want, 1e-9);
  const Pair other = with_unseen(p, seen, 1, 0);
  EXPECT_EQ(psnr_db(other.truth, other.image, &seen), psnr_db(p.truth, p.image, &seen));
  const PixelMask none(41, 33, std::uint8_t{0});
  EXPECT_EQ(psnr_db(p.truth, p.image, &none), 0);
}

TEST(SeenPixelsOnly, SsimCountsNoBlankWindows) {
  const Pair p = formula_pair(41, 33);
  const PixelMask all(41, 33, std::uint8_t{1}), none(41, 33, std::uint8_t{0});
  EXPECT_NEAR(*ssim(p.truth, p.image, &all), *ssim(p.truth, p.image), 1e-12);
  EXPECT_FALSE(ssim(p.truth, p.image, &none));

  const PixelMask seen = left_unseen(41, 33, 20);
  const Pair other = with_unseen(p, seen, 1, 0);
  EXPECT_EQ(*ssim(other.truth, other.image, &seen), *ssim(p.truth, p.image, &seen));
  // 31 columns of windows, of which 10 lie wholly in the dark.
  const Pair black = with_unseen(p, seen, 0, 0);
  const double mean = *ssim(black.truth, black.image);
  EXPECT_NEAR(*ssim(p.truth, p.image, &seen), (31 * mean - 10) / 21, 1e-6);
  EXPECT_LT(*ssim(p.truth, p.image, &seen), mean);
}

TEST(SeenPixelsOnly, ZeroUnseenIsBlackThere) {
  const ColorFloatImage image(6, 2, {0.5f, 0.25f, 1});
  const PixelMask seen = left_unseen(6, 2, 2);
  const ColorFloatImage out = zero_unseen(image, &seen);
  EXPECT_EQ(out(1, 1).b, 0);
  EXPECT_EQ(out(2, 1).b, 1);
  EXPECT_EQ(zero_unseen(image, nullptr)(0, 0).g, 0.25f);
}

}  // namespace
}  // namespace sgs::eval
