// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/camera/pyramid.h"

#include <gtest/gtest.h>

#include <cmath>
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

}  // namespace
}  // namespace sgs
