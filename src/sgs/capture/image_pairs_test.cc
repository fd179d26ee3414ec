// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/capture/image_pairs.h"

#include <gtest/gtest.h>

namespace sgs::capture {
namespace {

constexpr double kPeriod_s = 1.0 / 30;

CameraImage image(CameraImage::Kind kind, double stamp_s) {
  CameraImage image;
  image.kind = kind;
  image.stamp_s = stamp_s;
  return image;
}
CameraImage color(double stamp_s) { return image(CameraImage::Kind::kColor, stamp_s); }
CameraImage depth(double stamp_s) { return image(CameraImage::Kind::kDepth, stamp_s); }

TEST(ImagePairs, EqualStampsAreAPairAtOnce) {
  ImagePairs pairs(kPeriod_s, 0.6 * kPeriod_s);
  for (int i = 0; i < 10; ++i) {
    pairs.add(depth(i * kPeriod_s));
    EXPECT_FALSE(pairs.next());
    pairs.add(color(i * kPeriod_s));
    const auto pair = pairs.next();
    ASSERT_TRUE(pair);
    EXPECT_EQ(pair->color.stamp_s, pair->depth.stamp_s);
    EXPECT_FALSE(pairs.next());
  }
  EXPECT_EQ(pairs.alone(), 0);
}

TEST(ImagePairs, TheNearestColourIsWaitedFor) {
  ImagePairs pairs(kPeriod_s, 0.6 * kPeriod_s);
  pairs.add(color(0));
  pairs.add(depth(0.6 * kPeriod_s));
  EXPECT_FALSE(pairs.next());
  pairs.add(color(kPeriod_s));
  EXPECT_EQ(pairs.next()->color.stamp_s, kPeriod_s);
}

TEST(ImagePairs, DepthAtHalfTheRate) {
  ImagePairs pairs(kPeriod_s, 0.6 * kPeriod_s);
  int count = 0;
  for (int i = 0; i < 20; ++i) {
    pairs.add(color(i * kPeriod_s));
    if (i % 2 == 0) pairs.add(depth(i * kPeriod_s + 0.005));
    while (const auto pair = pairs.next()) {
      EXPECT_NEAR(pair->depth.stamp_s - pair->color.stamp_s, 0.005, 1e-9);
      ++count;
    }
  }
  EXPECT_EQ(count, 10);
}

TEST(ImagePairs, WhatComesTwiceOrIsFarApartIsNoPair) {
  ImagePairs pairs(kPeriod_s, 0.6 * kPeriod_s);
  pairs.add(depth(0));
  pairs.add(color(0));
  EXPECT_TRUE(pairs.next());
  pairs.add(color(1));
  pairs.add(color(1));
  pairs.add(depth(0.5));
  pairs.add(depth(1));
  const auto pair = pairs.next();
  ASSERT_TRUE(pair);
  EXPECT_EQ(pair->depth.stamp_s, 1);
  EXPECT_EQ(pairs.alone(), 1);
  EXPECT_FALSE(pairs.next());
}

TEST(ImagePairs, NothingIsKeptForEver) {
  ImagePairs pairs(kPeriod_s, 0.6 * kPeriod_s);
  for (int i = 0; i < 100; ++i) pairs.add(depth(i * kPeriod_s));
  EXPECT_GT(pairs.alone(), 90);
}

}  // namespace
}  // namespace sgs::capture
