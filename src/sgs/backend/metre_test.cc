// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/backend/metre.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sgs::backend {
namespace {

DepthEstimate with_offset(double per_m) {
  DepthEstimate e;
  e.keyframes = 20;
  e.calibration.grid = {2, 2};
  e.calibration.offset_per_m.assign(4, per_m);
  return e;
}

std::vector<Keyframe> all_at(double depth_m) {
  std::vector<Keyframe> out(3);
  for (Keyframe& k : out) k.mean_depth_m = depth_m;
  return out;
}

TEST(Metre, ScaleIsThatOfThePathAboutItsMiddle) {
  std::vector<MovedPose> poses(4);
  for (std::size_t k = 0; k < poses.size(); ++k) {
    poses[k].before.t = {static_cast<double>(k), 1, 0};
    poses[k].after.t = 1.02 * poses[k].before.t + Eigen::Vector3d(3, 0, 1);
  }
  EXPECT_NEAR(scale_of(poses), 1.02, 1e-12);
  EXPECT_EQ(scale_of({}), 1);
}

TEST(Metre, SharesAreOfTheMeanDepth) {
  DepthCalibration c = with_offset(0.003).calibration;
  EXPECT_NEAR(mean_depth_share(c, all_at(2)), 0.006, 1e-12);
  c.offset_per_m = {0.003, -0.003, 0.003, -0.003};
  EXPECT_NEAR(mean_depth_share(c, all_at(2)), 0, 1e-12);
  EXPECT_NEAR(rms_depth_share(c, all_at(2)), 0.006, 1e-12);
}

TEST(Metre, PathAndDepthTogetherContradict) {
  const auto said = metre_contradiction(with_offset(0.005), 1.022, 0.01);
  ASSERT_TRUE(said);
  EXPECT_THAT(*said, testing::HasSubstr("disagree on the metre by 2.2 %"));
}

TEST(Metre, EitherAloneDoesNot) {
  EXPECT_FALSE(metre_contradiction(with_offset(0.005), 1.01, 0.01));
  EXPECT_FALSE(metre_contradiction(with_offset(0.001), 1.022, 0.002));
}

}  // namespace
}  // namespace sgs::backend
