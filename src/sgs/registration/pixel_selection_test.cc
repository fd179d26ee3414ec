// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/registration/pixel_selection.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace sgs::registration {
namespace {

/// The rule as it reads, pixel by pixel.
std::vector<SelectedPixel> by_hand(const Image<float>& gray, int level, const DepthImage& depth,
                                   const PhotometricConfig& config) {
  const int block = config.block_at(level);
  std::vector<SelectedPixel> out;
  for (int y0 = 2; y0 + block < gray.height() - 2; y0 += block) {
    for (int x0 = 2; x0 + block < gray.width() - 2; x0 += block) {
      const auto threshold = static_cast<float>(config.gradient_threshold_at(level));
      float best = threshold * threshold;
      SelectedPixel pixel;
      for (int y = y0; y < y0 + block; ++y) {
        for (int x = x0; x < x0 + block; ++x) {
          const float gx = 0.5f * (gray(x + 1, y) - gray(x - 1, y));
          const float gy = 0.5f * (gray(x, y + 1) - gray(x, y - 1));
          const auto full = [level](int c, int size) {
            return std::min(static_cast<int>((c + 0.5) * (1 << level)), size - 1);
          };
          const float z = depth(full(x, depth.width()), full(y, depth.height()));
          const float g2 = gx * gx + gy * gy;
          if (!(g2 > best) || !(z > 0.1f) || !(z < static_cast<float>(config.max_depth_m)))
            continue;
          best = g2;
          pixel = {x, y};
        }
      }
      if (pixel.x >= 0) out.push_back(pixel);
    }
  }
  return out;
}

TEST(PixelSelection, TakesTheSteepestPixelWithDepthOfEachBlock) {
  std::mt19937 engine(1);
  std::uniform_real_distribution<float> value(0, 30);
  PhotometricConfig config;
  for (const int level : {0, 1, 2}) {
    for (const int width : {160, 83, 37}) {
      Image<float> gray(width, 61);
      DepthImage depth(width << level, 61 << level);
      for (std::size_t i = 0; i < gray.size(); ++i) gray.data()[i] = value(engine);
      for (std::size_t i = 0; i < depth.size(); ++i) {
        const float z = value(engine) / 4;  // some beyond the limit of 5 m
        depth.data()[i] = z < 1 ? 0 : z;
      }
      const auto expected = by_hand(gray, level, depth, config);
      const auto actual = select_pixels(gray, level, depth, config);
      ASSERT_GT(expected.size(), 3u);
      ASSERT_EQ(actual.size(), expected.size());
      for (std::size_t i = 0; i < actual.size(); ++i) {
        EXPECT_EQ(actual[i].x, expected[i].x);
        EXPECT_EQ(actual[i].y, expected[i].y);
      }
    }
  }
}

TEST(PixelSelection, NeedsGradientAndDepth) {
  PhotometricConfig config;
  Image<float> flat(80, 60, 100.0f), steep(80, 60);
  for (int y = 0; y < 60; ++y) {
    for (int x = 0; x < 80; ++x) steep(x, y) = 10.0f * static_cast<float>(x % 7);
  }
  const DepthImage depth(80, 60, 1.0f), none(80, 60, 0.0f);
  EXPECT_TRUE(select_pixels(flat, 0, depth, config).empty());
  EXPECT_TRUE(select_pixels(steep, 0, none, config).empty());
  EXPECT_FALSE(select_pixels(steep, 0, depth, config).empty());
  EXPECT_TRUE(select_pixels(Image<float>(4, 4), 0, DepthImage(4, 4, 1.0f), config).empty());
}

}  // namespace
}  // namespace sgs::registration
