// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapper/keyframe_culling.h"

#include <gtest/gtest.h>

#include "sgs/mapper/test_wall_scene.h"

namespace sgs::mapper {
namespace {

MapKeyframe seen_from(const SE3& T) {
  MapKeyframe keyframe(*wall_frame(small_camera(), translated(0, 0, 0), 0), T, 10);
  return keyframe;
}

TEST(KeyframeCulling, TheOlderOfTheTwoThatShowMostAlikeGoes) {
  std::vector<MapKeyframe> keyframes;
  for (const double x : {0.0, 0.5, 1.0, 1.1, 2.0, 0.45}) {
    keyframes.push_back(seen_from(translated(x, 0, 0)));
  }
  EXPECT_EQ(most_redundant(keyframes, {0, 1, 2, 3, 4, 5}), 1u);
  EXPECT_EQ(most_redundant(keyframes, {0, 2, 3, 4, 5}), 2u);
  EXPECT_EQ(most_redundant(keyframes, {0, 5}), 0u);
}

TEST(KeyframeCulling, TheFirstOneStays) {
  std::vector<MapKeyframe> keyframes;
  for (const double x : {0.0, 1.0, 0.01}) keyframes.push_back(seen_from(translated(x, 0, 0)));
  EXPECT_EQ(most_redundant(keyframes, {0, 1, 2}), 1u);
}

TEST(KeyframeCulling, TurningCountsLikeMoving) {
  std::vector<MapKeyframe> keyframes;
  keyframes.push_back(seen_from(translated(5, 0, 0)));
  keyframes.push_back(seen_from(SE3(so3_exp({0, 0.3, 0}), {0, 0, 0})));
  keyframes.push_back(seen_from(translated(0, 0, 0)));
  keyframes.push_back(seen_from(translated(0.2 * keyframes[0].mean_depth_m(), 0, 0)));
  EXPECT_EQ(most_redundant(keyframes, {0, 1, 2, 3}), 2u);
}

}  // namespace
}  // namespace sgs::mapper
