// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/refine/learned_harmonics.h"

#include <gmock/gmock.h>

namespace sgs::refine {
namespace {

using ::testing::Each;

LearnedHarmonics three() {
  map::Harmonics start{1, {}};
  start.resize(3);
  for (std::size_t i = 0; i < 3; ++i) start.of(i)[0] = static_cast<float>(i);
  return LearnedHarmonics(start);
}

float first(const LearnedHarmonics& harmonics, std::size_t i) {
  return harmonics.values().of(i)[0];
}

TEST(LearnedHarmonics, StepsGoAgainstTheGradient) {
  LearnedHarmonics harmonics = three();
  harmonics.set_rate(0.01);
  std::vector<float> gradient(9, 0.0f);
  gradient[1] = 5;
  gradient[2] = -1e-3f;
  harmonics.step(1, 1, gradient);
  EXPECT_NEAR(harmonics.values().of(1)[1], -0.01, 1e-5);  // Adam: a whole rate, whatever its size
  EXPECT_NEAR(harmonics.values().of(1)[2], 0.01, 1e-5);
  EXPECT_EQ(first(harmonics, 1), 1);
  EXPECT_EQ(harmonics.values().of(0)[1], 0);
}

TEST(LearnedHarmonics, NothingGrowsBeyondWhatAByteHolds) {
  LearnedHarmonics harmonics = three();
  harmonics.set_rate(0.3);
  std::vector<float> gradient(9, 0.0f);
  gradient[0] = -1;
  gradient[1] = 1;
  for (std::uint32_t t = 1; t < 9; ++t) {
    for (const std::size_t i : {0u, 2u}) harmonics.step(i, t, gradient);
  }
  EXPECT_EQ(first(harmonics, 0), map::kLargestHarmonic);
  EXPECT_EQ(harmonics.values().of(0)[1], -map::kLargestHarmonic);
  EXPECT_EQ(first(harmonics, 2), 2);  // came with more
}

TEST(LearnedHarmonics, RowsFollowRemovalsSplitsAndNewOnes) {
  LearnedHarmonics harmonics = three();
  const std::vector<char> removed = {0, 1, 0};
  harmonics.remove(removed);
  ASSERT_EQ(harmonics.values().size(), 2u);
  EXPECT_EQ(first(harmonics, 1), 2);
  harmonics.split(1);
  ASSERT_EQ(harmonics.values().size(), 3u);
  EXPECT_EQ(first(harmonics, 2), 2);
  harmonics.resize(5);
  EXPECT_THAT(harmonics.values().of(4), Each(0.0f));
}

TEST(LearnedHarmonics, OfDegreeZeroThereIsNothing) {
  LearnedHarmonics harmonics{map::Harmonics()};
  harmonics.resize(7);
  harmonics.remove(std::vector<char>(7, 0));
  EXPECT_TRUE(harmonics.empty());
  EXPECT_TRUE(harmonics.values().coefficients.empty());
}

}  // namespace
}  // namespace sgs::refine
