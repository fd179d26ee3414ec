// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/camera/pyramid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "sgs/camera/luma_row.h"

namespace sgs {
namespace {

PinholeCamera camera_of(int width, int height) {
  return {width, height, 0.8 * width, 0.82 * width, 0.51 * width, 0.48 * height};
}

// An image that is affine in pixel coordinates: every level samples the same plane.
Image<float> ramp(const PinholeCamera& c) {
  Image<float> image(c.width, c.height);
  for (int y = 0; y < c.height; ++y) {
    for (int x = 0; x < c.width; ++x) {
      image(x, y) = 20 + 0.25f * static_cast<float>(x) + 0.5f * static_cast<float>(y);
    }
  }
  return image;
}

TEST(LumaRow, IsLumaToTheBitForAnyWidth) {
  std::vector<Rgb8> pixels(300);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const auto byte = [&](std::size_t factor) { return static_cast<std::uint8_t>(factor * i); };
    pixels[i] = {byte(37), byte(101), byte(211)};
  }
  for (const std::size_t width : {1, 2, 3, 7, 8, 9, 15, 16, 17, 255, 300}) {
    std::vector<float> row(width + 1, -1);
    luma_row(pixels.data(), row.data(), width);
    for (std::size_t i = 0; i < width; ++i) EXPECT_EQ(row[i], luma(pixels[i])) << i;
    EXPECT_EQ(row[width], -1);
  }
}

TEST(GrayPyramid, RampKeepsItsPlaneOnEveryLevel) {
  const PinholeCamera c = camera_of(161, 98);
  GrayPyramid pyramid;
  pyramid.build(ramp(c), c, 4);
  ASSERT_EQ(pyramid.levels(), 4);
  for (int l = 0; l < 4; ++l) {
    const auto& level = pyramid.level(l);
    EXPECT_EQ(level.camera, c.halved(l));
    EXPECT_EQ(level.gray.width(), 161 >> l);
    const float s = static_cast<float>(1 << l);
    const float u = 3.3f, v = 4.7f;
    const GraySample g = level.interpolate(u, v);
    const float full_u = (u + 0.5f) * s - 0.5f, full_v = (v + 0.5f) * s - 0.5f;
    EXPECT_NEAR(g.intensity, 20 + 0.25f * full_u + 0.5f * full_v, 1e-3);
    EXPECT_NEAR(g.gx, 0.25f * s, 1e-4);
    EXPECT_NEAR(g.gy, 0.5f * s, 1e-4);
  }
}

TEST(GrayPyramid, LumaOfColour) {
  const PinholeCamera c = camera_of(32, 24);
  ColorImage image(32, 24, {10, 200, 90});
  GrayPyramid pyramid;
  pyramid.build(image, c, 2);
  for (int l = 0; l < 2; ++l) {
    EXPECT_NEAR(pyramid.level(l).gray(5, 6), luma({10, 200, 90}), 1e-3);
    EXPECT_EQ(pyramid.level(l).interpolate(5, 6).gx, 0);
  }
}

TEST(GrayPyramid, RebuildingReusesMemoryAndForgetsTheOldImage) {
  const PinholeCamera c = camera_of(64, 48);
  GrayPyramid pyramid, fresh;
  pyramid.build(ColorImage(64, 48, {255, 255, 255}), c, 3);
  const float* before = pyramid.level(1).gray.data();
  pyramid.build(ramp(c), c, 3);
  fresh.build(ramp(c), c, 3);
  EXPECT_EQ(pyramid.level(1).gray.data(), before);
  for (int l = 0; l < 3; ++l) {
    const auto &a = pyramid.level(l), &b = fresh.level(l);
    for (int y = 0; y < a.gray.height(); ++y) {
      for (int x = 0; x < a.gray.width(); ++x) {
        ASSERT_EQ(a.gray(x, y), b.gray(x, y));
      }
    }
  }
}

TEST(GrayPyramid, TinyImagesGetFewerLevelsAndWrongSizesThrow) {
  const PinholeCamera c = camera_of(40, 30);
  GrayPyramid pyramid;
  pyramid.build(ColorImage(40, 30), c, 6);
  EXPECT_EQ(pyramid.levels(), 2);
  EXPECT_THROW(pyramid.build(ColorImage(41, 30), c, 2), ContractViolation);
  EXPECT_THROW(pyramid.build(ColorImage(40, 30), c, 0), ContractViolation);
}

ColorImage grey_steps(int width, int height) {
  ColorImage image(width, height);
  for (std::size_t i = 0; i < image.size(); ++i) {
    const auto g = static_cast<std::uint8_t>(31 * i % 251);
    image.data()[i] = {g, g, g};
  }
  return image;
}

TEST(GrayPyramid, PixelsThatWereNotSeenAreInNoMean) {
  const PinholeCamera c = camera_of(32, 24);
  const ColorImage image = grey_steps(32, 24);
  PixelMask seen(32, 24, std::uint8_t{1});
  seen(4, 6) = 0;                                         // one of four
  seen(10, 10) = seen(11, 11) = 0;                        // two
  seen(20, 2) = seen(21, 2) = seen(20, 3) = 0;            // three
  seen(0, 0) = seen(1, 0) = seen(0, 1) = seen(1, 1) = 0;  // all
  GrayPyramid all, pyramid;
  all.build(image, c, 2);
  pyramid.build(image, c, 2, &seen);
  const Image<float>&fine = pyramid.level(0).gray, &coarse = pyramid.level(1).gray;
  for (int v = 0; v < 24; ++v) {
    for (int u = 0; u < 32; ++u) {
      ASSERT_EQ(std::isnan(fine(u, v)), seen(u, v) == 0) << u << " " << v;
      EXPECT_TRUE(seen(u, v) == 0 || fine(u, v) == all.level(0).gray(u, v));
    }
  }
  EXPECT_FLOAT_EQ(coarse(2, 3), (fine(5, 6) + fine(4, 7) + fine(5, 7)) / 3);
  EXPECT_FLOAT_EQ(coarse(5, 5), (fine(11, 10) + fine(10, 11)) / 2);
  EXPECT_TRUE(std::isnan(coarse(10, 1)));
  EXPECT_TRUE(std::isnan(coarse(0, 0)));
  EXPECT_FLOAT_EQ(coarse(8, 8), all.level(1).gray(8, 8));
}

TEST(GrayPyramid, LookupThatTouchesAnUnseenPixelIsNone) {
  const PinholeCamera c = camera_of(32, 24);
  PixelMask seen(32, 24, std::uint8_t{1});
  seen(10, 10) = 0;
  GrayPyramid pyramid;
  pyramid.build(grey_steps(32, 24), c, 1, &seen);
  const auto usable = [&](float u, float v) {
    const GraySample s = pyramid.level(0).interpolate(u, v);
    return !std::isnan(s.intensity + s.gx + s.gy);
  };
  EXPECT_FALSE(usable(10.2f, 10.3f));
  EXPECT_FALSE(usable(9.5f, 9.5f));
  EXPECT_FALSE(usable(11.5f, 10.2f));  // by its gradient
  EXPECT_TRUE(usable(14.5f, 10.2f));
  EXPECT_TRUE(usable(9.5f, 13.5f));
}

TEST(GrayPyramid, MaskOfAllChangesNothing) {
  const PinholeCamera c = camera_of(64, 48);
  const PixelMask seen(64, 48, std::uint8_t{1});
  GrayPyramid all, masked;
  all.build(grey_steps(64, 48), c, 3);
  masked.build(grey_steps(64, 48), c, 3, &seen);
  for (int l = 0; l < 3; ++l) {
    const Image<float>&a = all.level(l).gray, &b = masked.level(l).gray;
    for (std::size_t i = 0; i < a.size(); ++i) EXPECT_FLOAT_EQ(a.data()[i], b.data()[i]);
  }
}

}  // namespace
}  // namespace sgs
