// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/camera/resample.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

namespace sgs {
namespace {

/// What a camera sees of a smooth pattern on the plane z = 1.
Rgb8 pattern(const PinholeCamera& camera, double u, double v) {
  const double x = (u - camera.cx) / camera.fx, y = (v - camera.cy) / camera.fy;
  const auto wave = [](double t) {
    return static_cast<std::uint8_t>(std::lround(127 + 100 * std::sin(t)));
  };
  return {wave(6 * x), wave(5 * y), wave(4 * (x + y))};
}

ColorImage picture(const PinholeCamera& camera) {
  ColorImage image(camera.width, camera.height);
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) image(u, v) = pattern(camera, u, v);
  }
  return image;
}

/// Largest difference from what `camera` sees itself, borders left out.
int largest_error(const ColorImage& image, const PinholeCamera& camera, int border) {
  int largest = 0;
  for (int v = border; v < image.height() - border; ++v) {
    for (int u = border; u < image.width() - border; ++u) {
      const Rgb8 want = pattern(camera, u, v), got = image(u, v);
      for (const int d : {want.r - got.r, want.g - got.g, want.b - got.b}) {
        largest = std::max(largest, std::abs(d));
      }
    }
  }
  return largest;
}

const PinholeCamera kFrom{96, 72, 90, 91, 47.1, 35.6};

TEST(Resample, EqualCamerasChangeNothing) {
  const ColorImage image = picture(kFrom);
  const ColorImage out = resample_color(image, kFrom, kFrom);
  EXPECT_TRUE(std::equal(image.data(), image.data() + image.size(), out.data()));
}

TEST(Resample, ColourIsWhatTheOtherCameraSees) {
  for (const PinholeCamera& to :
       {PinholeCamera{48, 36, 45, 45.5, 23.3, 17.55},     // exactly half
        PinholeCamera{60, 45, 56.25, 56.875, 29.25, 22},  // by 1.6
        PinholeCamera{96, 72, 92, 90, 45, 37},            // another focal length and centre
        PinholeCamera{40, 30, 38, 37, 20.4, 14.1}}) {     // both
    const ColorImage out = resample_color(picture(kFrom), kFrom, to);
    EXPECT_LE(largest_error(out, to, 4), 3) << to.width;
  }
}

TEST(Resample, DepthIsNeverMixed) {
  DepthImage depth(kFrom.width, kFrom.height, 1.0f);
  for (int v = 0; v < kFrom.height; ++v) {
    for (int u = 48; u < kFrom.width; ++u) depth(u, v) = 3.0f;
  }
  const PinholeCamera to = scaled_to(kFrom, 61, 47);
  const DepthImage out = resample_depth(depth, kFrom, to);
  for (int v = 0; v < to.height; ++v) {
    for (int u = 0; u < to.width; ++u) {
      const double source = (u - to.cx) * kFrom.fx / to.fx + kFrom.cx;
      EXPECT_EQ(out(u, v), source < 47.5 ? 1.0f : 3.0f) << u;
    }
  }
}

TEST(Resample, WhatTheDepthCameraDoesNotSeeHasNoDepth) {
  const DepthImage depth(kFrom.width, kFrom.height, 1.0f);
  const PinholeCamera wide{96, 72, 45, 45.5, 47.1, 35.6};
  const DepthImage out = resample_depth(depth, kFrom, wide);
  EXPECT_EQ(out(48, 36), 1.0f);
  EXPECT_EQ(out(2, 36), 0.0f);
  EXPECT_EQ(out(48, 70), 0.0f);
}

TEST(Resample, SeenAreThePixelsThatTheOtherCameraHas) {
  EXPECT_EQ(seen_by(kFrom, kFrom), nullptr);
  EXPECT_EQ(seen_by(kFrom, {48, 36, 45, 45.5, 23.3, 17.55}), nullptr);
  EXPECT_EQ(seen_by(kFrom, kFrom.halved(1)), nullptr);
  const PinholeCamera large{1296, 968, 1170, 1171, 647.5, 483.5};
  EXPECT_EQ(seen_by(large, limited_to_width(large, 640)), nullptr);

  const PinholeCamera wider{96, 72, 60, 61, 47.1, 35.6};
  const auto seen = seen_by(kFrom, wider);
  ASSERT_NE(seen, nullptr);
  int wrong = 0;
  for (int v = 0; v < wider.height; ++v) {
    for (int u = 0; u < wider.width; ++u) {
      const Eigen::Vector2d at = kFrom.project(wider.back_project(u, v, 1));
      const bool inside = at.x() > -0.5 && at.y() > -0.5 && at.x() < kFrom.width - 0.5 &&
                          at.y() < kFrom.height - 0.5;
      wrong += inside != ((*seen)(u, v) != 0);
    }
  }
  EXPECT_EQ(wrong, 0);
}

TEST(Resample, AFrameKnowsWhatTheOtherCameraHasNotSeen) {
  RgbdFrame frame;
  frame.index = 7;
  frame.camera = kFrom;
  frame.color = picture(kFrom);
  frame.depth = DepthImage(kFrom.width, kFrom.height, 2.0f);
  EXPECT_EQ(resampled(frame, kFrom).seen, nullptr);
  PixelMask seen(kFrom.width, kFrom.height, std::uint8_t{1});
  for (int v = 0; v < kFrom.height; ++v) std::fill_n(seen.row(v), 10, std::uint8_t{0});
  frame.seen = std::make_shared<const PixelMask>(seen);
  const RgbdFrame half = resampled(frame, kFrom.halved(1));
  EXPECT_EQ(half.index, 7);
  EXPECT_EQ(half.camera, kFrom.halved(1));
  EXPECT_LE(largest_error(half.color, half.camera, 1), 3);
  EXPECT_EQ(half.depth(20, 20), 2);
  for (int v = 0; v < half.camera.height; ++v) {
    for (int u = 0; u < half.camera.width; ++u) ASSERT_EQ(half.sees(u, v), u >= 5) << u << " " << v;
  }
}

TEST(Resample, WidthIsLimitedByWholeFactorsWhereThatLeavesEnough) {
  const auto width = [](int from) {
    return limited_to_width({from, from / 2, 500, 500, 1, 1}, 640).width;
  };
  EXPECT_EQ(width(640), 640);
  EXPECT_EQ(width(1280), 640);
  EXPECT_EQ(width(1920), 640);
  EXPECT_EQ(width(1024), 512);
  EXPECT_EQ(width(1200), 600);
  EXPECT_EQ(width(1296), 640);  // by 3 would leave 432
  EXPECT_EQ(width(848), 640);
  const PinholeCamera camera{1296, 968, 1170, 1171, 647.5, 483.5};
  EXPECT_EQ(limited_to_width(camera, 0), camera);
  const PinholeCamera small = limited_to_width(camera, 640);
  EXPECT_EQ(small.height, 478);
  EXPECT_NEAR(small.fx / small.fy, camera.fx / camera.fy, 1e-12);
  EXPECT_NEAR(small.cx, (647.5 + 0.5) * 640 / 1296 - 0.5, 1e-9);
}

}  // namespace
}  // namespace sgs
