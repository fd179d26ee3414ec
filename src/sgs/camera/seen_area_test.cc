// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/camera/seen_area.h"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

namespace sgs {
namespace {

/// Rows of the mask, '#' for a pixel that was seen.
PixelMask mask_of(const std::vector<std::string>& rows) {
  PixelMask mask(static_cast<int>(rows[0].size()), static_cast<int>(rows.size()));
  for (int y = 0; y < mask.height(); ++y) {
    for (int x = 0; x < mask.width(); ++x) {
      mask(x, y) = rows[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)] == '#';
    }
  }
  return mask;
}

bool all_seen(const PixelMask& mask, const PixelArea& a) {
  for (int y = a.y; y < a.y + a.height; ++y) {
    for (int x = a.x; x < a.x + a.width; ++x) {
      if (mask(x, y) == 0) return false;
    }
  }
  return true;
}

/// By trying all.
int largest_by_trying(const PixelMask& mask) {
  int best = 0;
  for (int y = 0; y < mask.height(); ++y) {
    for (int x = 0; x < mask.width(); ++x) {
      for (int h = 1; y + h <= mask.height(); ++h) {
        for (int w = 1; x + w <= mask.width(); ++w) {
          if (w * h > best && all_seen(mask, {x, y, w, h})) best = w * h;
        }
      }
    }
  }
  return best;
}

void expect_area(const PixelArea& area, int x, int y, int width, int height) {
  EXPECT_EQ(area.x, x);
  EXPECT_EQ(area.y, y);
  EXPECT_EQ(area.width, width);
  EXPECT_EQ(area.height, height);
}

TEST(SeenArea, IsTheWholePictureNothingOrWhatABorderLeaves) {
  expect_area(largest_seen_area(mask_of({"####", "####"})), 0, 0, 4, 2);
  expect_area(largest_seen_area(mask_of({"....", "...."})), 0, 0, 0, 0);
  expect_area(largest_seen_area(mask_of({".....", ".###.", ".###.", "....."})), 1, 1, 3, 2);
  expect_area(largest_seen_area(mask_of({".##..", "#####", "#####", "..##."})), 0, 1, 5, 2);
  expect_area(largest_seen_area(mask_of({"...#", "...#", "...#"})), 3, 0, 1, 3);
}

TEST(SeenArea, NoRectangleIsLarger) {
  std::mt19937 random(5);
  for (int trial = 0; trial < 200; ++trial) {
    PixelMask mask(1 + static_cast<int>(random() % 9), 1 + static_cast<int>(random() % 7));
    for (std::size_t i = 0; i < mask.size(); ++i) mask.data()[i] = random() % 4 > 0;
    const PixelArea area = largest_seen_area(mask);
    EXPECT_TRUE(all_seen(mask, area));
    EXPECT_EQ(area.width * area.height, largest_by_trying(mask));
  }
}

TEST(SeenArea, ShareCountsPixels) {
  EXPECT_DOUBLE_EQ(seen_share(mask_of({"##..", "#..."})), 3.0 / 8);
  EXPECT_EQ(seen_share(mask_of({"##", "##"})), 1);
  EXPECT_EQ(seen_share(PixelMask{}), 1);
}

TEST(SeenArea, CroppedIsThatPart) {
  ColorImage picture(5, 4);
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 5; ++x) {
      picture(x, y) = {static_cast<std::uint8_t>(x), static_cast<std::uint8_t>(y), 7};
    }
  }
  const ColorImage part = cropped(picture, {1, 2, 3, 2});
  ASSERT_EQ(part.width(), 3);
  ASSERT_EQ(part.height(), 2);
  EXPECT_EQ(part(0, 0), picture(1, 2));
  EXPECT_EQ(part(2, 1), picture(3, 3));
}

}  // namespace
}  // namespace sgs
