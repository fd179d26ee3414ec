// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/registration/cover_image.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace sgs::registration {
namespace {

constexpr int kAcross = 80, kDown = 60;  // cells
constexpr float kOpen = std::numeric_limits<float>::infinity();
const CellCamera kOnto{70, 70, 40, 30, 0.05f};

/// A wall at 2 m in the left half of the picture, at 4 m in the right half.
std::vector<float> two_walls() {
  std::vector<float> depths(kAcross * kDown, 2.0f);
  for (int row = 0; row < kDown; ++row) {
    for (int column = kAcross / 2; column < kAcross; ++column) depths[row * kAcross + column] = 4;
  }
  return depths;
}

bool covered(const std::vector<float>& depths, float x, float z, float radius = 0.2f,
             float margin_m = 0.05f) {
  CoverImage image(kOnto, kAcross, kDown);
  image.draw(depths);
  return image.covers({x, 0, z}, radius, margin_m);
}

TEST(CoverImage, CoversWhatLiesWhollyBehindAllBeforeIt) {
  const auto walls = two_walls();
  EXPECT_TRUE(covered(walls, -0.8f, 3));
  EXPECT_FALSE(covered(walls, -0.8f, 2.2f));  // its near side is not behind
  EXPECT_FALSE(covered(walls, -0.8f, 1.5f));
  EXPECT_FALSE(covered(walls, 0.8f, 3));  // before the wall on the right
  EXPECT_FALSE(covered(walls, 0, 3));     // half of it
  EXPECT_TRUE(covered(walls, 0, 5));
  EXPECT_FALSE(covered(walls, -0.8f, 3, 1.1f));
  EXPECT_FALSE(covered(walls, -0.8f, 3, 0.2f, 1));
}

TEST(CoverImage, NothingIsCoveredThroughAnOpening) {
  auto walls = two_walls();
  EXPECT_FALSE(CoverImage(kOnto, kAcross, kDown).covers({0, 0, 9}, 0.1f, 0));
  for (int row = 20; row < 40; ++row) {
    for (int column = 16; column < 28; ++column) walls[row * kAcross + column] = kOpen;
  }
  EXPECT_FALSE(covered(walls, -0.8f, 3));
  EXPECT_TRUE(covered(walls, -1.6f, 3));
}

TEST(CoverImage, SingleGapsBetweenPointsAreNoOpening) {
  auto walls = two_walls();
  for (std::size_t i = 0; i < walls.size(); i += 3) walls[i] = kOpen;
  EXPECT_TRUE(covered(walls, -0.8f, 3));
}

TEST(CoverImage, WhatReachesTheCameraIsNotCovered) {
  EXPECT_FALSE(covered(two_walls(), 0, 3, 3));
  EXPECT_FALSE(covered(two_walls(), 0, -3, 1));
  EXPECT_FALSE(covered(two_walls(), std::numeric_limits<float>::quiet_NaN(), 9));
}

}  // namespace
}  // namespace sgs::registration
