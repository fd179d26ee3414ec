// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/registration/target_blocks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "sgs/core/random.h"
#include "sgs/registration/cell_match.h"

namespace sgs::registration {
namespace {

constexpr int kColumns = 80, kRows = 60;  // cells
const CellCamera kLooking{70, 70, 40, 30, 0.05f};
const ViewPyramid kView({70, 70}, {40, 30}, {0, 0}, {kColumns, kRows});

Eigen::Vector3f random_point(SplitMix64& random, double most) {
  const auto at = [&] { return static_cast<float>(most * (2 * random.uniform() - 1)); };
  const float x = at(), y = at(), z = at();
  return {x, y, z};
}

/// Patches of a few decimetres all around, as keyframes of a way through rooms leave them.
TargetCloud patches(int count, SplitMix64& random) {
  TargetCloud cloud;
  for (int k = 0; k < count; ++k) {
    const Eigen::Vector3f centre = random_point(random, 6);
    for (int i = 0; i < 2 * static_cast<int>(TargetBlocks::kBlock); ++i) {
      cloud.points.push_back({centre + random_point(random, 0.2), {0, 0, -1}, 1e-6f});
    }
  }
  return cloud;
}

SE3 random_pose(SplitMix64& random) {
  return {so3_exp(random_point(random, 3).cast<double>()), random_point(random, 3).cast<double>()};
}

/// How many points lie in the ranges; fails where one is left out that the camera sees.
std::size_t points_looked_at(TargetBlocks& blocks, const TargetCloud& cloud, const SE3& T) {
  std::vector<bool> looked_at(cloud.points.size(), false);
  std::size_t count = 0, last = 0;
  for (const auto& range : blocks.in_view(kView, T)) {
    EXPECT_TRUE(count == 0 || range.begin > last);
    EXPECT_LE(range.end, cloud.points.size());
    for (std::size_t i = range.begin; i < range.end; ++i) looked_at[i] = true;
    count += range.end - range.begin;
    last = range.end;
  }
  const SE3 inverse = T.inverse();
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const Eigen::Vector3f p =
        inverse.R.cast<float>() * cloud.points[i].point + inverse.t.cast<float>();
    EXPECT_TRUE(looked_at[i] || cell_of(kLooking, kColumns, kRows, p) < 0) << i;
  }
  return count;
}

TEST(TargetBlocks, LeaveOutMostOfAMapAndNothingThatIsSeen) {
  SplitMix64 random(7);
  const TargetCloud cloud = patches(400, random);
  TargetBlocks blocks;
  blocks.follow(cloud);
  std::size_t looked_at = 0;
  constexpr int kViews = 30;
  for (int k = 0; k < kViews; ++k) {
    looked_at += points_looked_at(blocks, cloud, random_pose(random));
  }
  EXPECT_GT(looked_at, 0u);
  EXPECT_LT(static_cast<double>(looked_at) / kViews,
            0.3 * static_cast<double>(cloud.points.size()));
}

TEST(TargetBlocks, FollowWhatIsAddedMovedAndForgotten) {
  SplitMix64 random(8);
  TargetCloud cloud;
  TargetBlocks blocks;
  blocks.follow(cloud);
  EXPECT_TRUE(blocks.in_view(kView, SE3{}).empty());
  cloud.points.push_back({{0, 0, 2}, {0, 0, -1}, 1e-6f});
  blocks.follow(cloud);
  EXPECT_EQ(points_looked_at(blocks, cloud, SE3{}), 1u);
  // The block that was not full goes on being filled.
  for (int i = 0; i < 100; ++i) cloud.points.push_back({{0.1f, 0, 2}, {0, 0, -1}, 1e-6f});
  blocks.follow(cloud);
  EXPECT_EQ(points_looked_at(blocks, cloud, SE3{}), 101u);
  for (TargetPoint& p : cloud.points) p.point.z() = -2;
  ++cloud.moves;
  blocks.follow(cloud);
  EXPECT_TRUE(blocks.in_view(kView, SE3{}).empty());
  cloud.points.resize(1);
  cloud.points[0].point.z() = 3;
  ++cloud.layout;
  blocks.follow(cloud);
  EXPECT_EQ(points_looked_at(blocks, cloud, SE3{}), 1u);
}

TEST(TargetBlocks, APointThatIsNotANumberHidesNoOther) {
  TargetCloud cloud;
  cloud.points.push_back({{0, 0, 2}, {0, 0, -1}, 1e-6f});
  cloud.points.push_back({{0, std::numeric_limits<float>::quiet_NaN(), 2}, {0, 0, -1}, 1e-6f});
  TargetBlocks blocks;
  blocks.follow(cloud);
  EXPECT_EQ(points_looked_at(blocks, cloud, SE3{}), 2u);
}

}  // namespace
}  // namespace sgs::registration
