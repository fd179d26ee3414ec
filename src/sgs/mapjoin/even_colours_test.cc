// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapjoin/even_colours.h"

#include <gtest/gtest.h>

namespace sgs::mapjoin {
namespace {

/// Two maps of one wall, the second one darker; of its Gaussians every tenth shows something else.
Part two_walls(int count) {
  Part part;
  for (int i = 0; i < 2 * count; ++i) {
    const bool other = i >= count;
    map::Gaussian g{};
    g.mean[0] = 0.05f * static_cast<float>(i % count) + 0.01f;
    g.opacity_logit = 3;
    for (float& colour : g.rgb) colour = other ? 0.3f : 0.4f;
    if (other && i % 10 == 0) g.rgb[0] = 0.8f;
    part.gaussians.splats.gaussians.push_back(g);
    part.gaussians.born_in.push_back(other ? 1 : 0);
    part.gaussians.born_s.push_back(0);
  }
  return part;
}

TEST(EvenColours, TheOtherMapTakesTheColoursOfTheBase) {
  Part part = two_walls(300);
  for (const float factor : even_colours(part, 1)) EXPECT_NEAR(factor, 4.0f / 3, 1e-3f);
  EXPECT_EQ(part.gaussians.splats.gaussians[0].rgb[1], 0.4f);
  EXPECT_NEAR(part.gaussians.splats.gaussians.back().rgb[1], 0.4f, 1e-3f);
}

TEST(EvenColours, LittleInCommonSaysNothing) {
  Part part = two_walls(20);
  for (const float factor : even_colours(part, 1)) EXPECT_EQ(factor, 1.0f);
  EXPECT_EQ(part.gaussians.splats.gaussians.back().rgb[1], 0.3f);
}

}  // namespace
}  // namespace sgs::mapjoin
