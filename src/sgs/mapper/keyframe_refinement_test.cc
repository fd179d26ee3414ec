// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapper/keyframe_refinement.h"

#include <gtest/gtest.h>

#include <limits>

#include "sgs/mapper/test_wall_scene.h"

namespace {

using namespace sgs;
using namespace sgs::mapper;

TEST(KeyframeRefinement, ReturnsToTheTrackedPoseWhereNothingIsSeen) {
  const KeyframeRefinementConfig config;
  MapKeyframe keyframe(*wall_frame(small_camera(), SE3{}), SE3{}, 10);
  Vector6d offset;
  offset << 1e-3, -2e-3, 5e-4, 2e-3, 1e-3, -1e-3;
  keyframe.T_world_camera = SE3::exp(offset);
  refine_pose(keyframe, Vector6d::Zero(), 4800, config);
  EXPECT_LT(keyframe.T_world_camera.log().norm(), 0.02 * offset.norm());
}

TEST(KeyframeRefinement, StepsAreBoundedAndOnlyFiniteGradientsCount) {
  const KeyframeRefinementConfig config;
  MapKeyframe keyframe(*wall_frame(small_camera(), SE3{}), SE3{}, 10);
  Vector6d gradient = Vector6d::Constant(1e9);
  refine_pose(keyframe, gradient, 4800, config);
  EXPECT_LT(keyframe.T_world_camera.log().norm(), 5.1e-3);
  const SE3 before = keyframe.T_world_camera;
  gradient[2] = std::numeric_limits<double>::quiet_NaN();
  refine_pose(keyframe, gradient, 4800, config);
  EXPECT_EQ((keyframe.T_world_camera.t - before.t).norm(), 0);
}

}  // namespace
