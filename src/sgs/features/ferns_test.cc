// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/features/ferns.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sgs/core/error.h"
#include "sgs/core/random.h"

namespace sgs::features {
namespace {

// A view of soft blobs; `seed` decides where they are, `shift` moves all of them.
RgbdFrame view(std::uint64_t seed, float shift, float gain) {
  RgbdFrame frame;
  frame.camera = {160, 120, 134, 135, 80, 62};
  frame.color = ColorImage(160, 120);
  frame.depth = DepthImage(160, 120);
  SplitMix64 random(seed);
  struct Blob {
    double x, y, size, red, green, depth;
  };
  std::vector<Blob> blobs(24);
  for (Blob& b : blobs) {
    b = {160 * random.uniform(),      120 * random.uniform(),      8 + 20 * random.uniform(),
         120 * random.uniform() - 60, 120 * random.uniform() - 60, random.uniform() - 0.5};
  }
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 160; ++x) {
      double red = 90, green = 90, depth = 2;
      for (const Blob& b : blobs) {
        const double dx = x + double{shift} - b.x, dy = y - b.y;
        const double w = std::exp(-(dx * dx + dy * dy) / (2 * b.size * b.size));
        red += w * b.red;
        green += w * b.green;
        depth += w * b.depth;
      }
      const auto byte8 = [&](double v) {
        return static_cast<std::uint8_t>(std::clamp(double{gain} * v, 0.0, 255.0));
      };
      frame.color(x, y) = {byte8(red), byte8(green), byte8(90)};
      frame.depth(x, y) = static_cast<float>(depth);
    }
  }
  return frame;
}

TEST(Ferns, ThePlaceIsKnownAgainWithAnyExposure) {
  const Ferns ferns(1);
  const FernCode here = ferns.code(view(5, 0, 1));
  EXPECT_DOUBLE_EQ(Ferns::similarity(here, here), 1);
  for (const float gain : {0.7f, 0.85f, 1.15f, 1.3f}) {
    EXPECT_GT(Ferns::similarity(here, ferns.code(view(5, 3, gain))), 0.6) << gain;
  }
}

TEST(Ferns, OtherPlacesAreNot) {
  const Ferns ferns(1);
  const FernCode here = ferns.code(view(5, 0, 1));
  for (std::uint64_t other = 10; other < 40; ++other) {
    EXPECT_LT(Ferns::similarity(here, ferns.code(view(other, 0, 1))), 0.35) << other;
  }
}

TEST(Ferns, WithoutDepthNothingIsSaid) {
  const Ferns ferns(1);
  RgbdFrame blind = view(5, 0, 1);
  blind.depth.fill(0);
  EXPECT_EQ(Ferns::similarity(ferns.code(view(5, 0, 1)), ferns.code(blind)), 0);
}

TEST(Ferns, TheSeedDecidesTheQuestions) {
  const RgbdFrame frame = view(5, 0, 1);
  EXPECT_EQ(Ferns(3).code(frame), Ferns(3).code(frame));
  EXPECT_NE(Ferns(3).code(frame), Ferns(4).code(frame));
}

}  // namespace
}  // namespace sgs::features
