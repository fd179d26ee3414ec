// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/slam/pose_correction.h"

#include <gtest/gtest.h>

namespace sgs::slam {
namespace {

SE3 pose(double x, double y, double z, double yaw) {
  Vector6d xi;
  xi << 0, 0, yaw, 0, 0, 0;
  SE3 T = SE3::exp(xi);
  T.t = {x, y, z};
  return T;
}

KeyframePose keyframe(std::int64_t index, double time_s, const SE3& tracked, const SE3& refined) {
  return {index, time_s, tracked, refined};
}

double distance(const SE3& a, const SE3& b) { return (a.inverse() * b).log().norm(); }

TEST(PoseCorrection, LeavesPosesAloneWithoutKeyframes) {
  const SE3 T = pose(1, 2, 3, 0.4);
  EXPECT_LT(distance(corrected_pose(T, 1.0, {}), T), 1e-12);
}

TEST(PoseCorrection, PutsKeyframesWhereTheyWereRefined) {
  const std::vector<KeyframePose> keyframes = {
      keyframe(0, 0, pose(0, 0, 0, 0), pose(0, 0, 0, 0)),
      keyframe(10, 1, pose(1, 0, 0, 0.2), pose(1.02, 0.01, 0, 0.21))};
  for (const KeyframePose& k : keyframes) {
    EXPECT_LT(distance(corrected_pose(k.T_odom_camera, k.timestamp_s, keyframes), k.T_world_camera),
              1e-9);
  }
}

TEST(PoseCorrection, InterpolatesBetweenAndHoldsBeyond) {
  const std::vector<KeyframePose> keyframes = {
      keyframe(0, 0, pose(0, 0, 0, 0), pose(0, 0, 0, 0)),
      keyframe(10, 1, pose(1, 0, 0, 0), pose(1, 0.1, 0, 0))};
  EXPECT_NEAR(corrected_pose(pose(0.25, 0, 0, 0), 0.25, keyframes).t.y(), 0.025, 1e-12);
  EXPECT_NEAR(corrected_pose(pose(2, 0, 0, 0), 2.0, keyframes).t.y(), 0.1, 1e-12);
  EXPECT_NEAR(corrected_pose(pose(-1, 0, 0, 0), -1.0, keyframes).t.y(), 0.0, 1e-12);
}

TEST(PoseCorrection, DoesNotDependOnTheWorldOrigin) {
  const SE3 shift = pose(100, -50, 7, 1.0);
  std::vector<KeyframePose> keyframes = {
      keyframe(0, 0, pose(0, 0, 0, 0), pose(0, 0, 0.01, 0)),
      keyframe(10, 1, pose(1, 0, 0, 0.3), pose(1.02, 0.05, 0, 0.33))};
  const SE3 T = pose(0.4, 0.1, 0, 0.1);
  const SE3 expected = shift * corrected_pose(T, 0.4, keyframes);
  for (KeyframePose& k : keyframes) {
    k.T_odom_camera = shift * k.T_odom_camera;
    k.T_world_camera = shift * k.T_world_camera;
  }
  EXPECT_LT(distance(corrected_pose(shift * T, 0.4, keyframes), expected), 1e-9);
}

}  // namespace
}  // namespace sgs::slam
