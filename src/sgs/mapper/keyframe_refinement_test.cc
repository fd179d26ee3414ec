// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapper/keyframe_refinement.h"

#include <gtest/gtest.h>

#include <limits>

#include "sgs/mapper/wall_scene.h"

namespace {

using namespace sgs;
using namespace sgs::mapper;

render::LossConfig color_only() {
  render::LossConfig loss;
  loss.color_weight = 4;
  loss.color_knee = 0.2f;
  loss.depth_weight = 0;
  return loss;
}

render::TrainingImage view(const SE3& T) {
  return MapKeyframe(*wall_frame(small_camera(), T), T, 10).training_image(1);
}

double squared_difference(const render::TrainingImage& a, const render::TrainingImage& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.color.size(); ++i) {
    const render::Rgbf &x = a.color.data()[i], &y = b.color.data()[i];
    for (const float e : {x.r - y.r, x.g - y.g, x.b - y.b}) {
      sum += static_cast<double>(e) * static_cast<double>(e);
    }
  }
  return sum;
}

TEST(KeyframeRefinement, InformationIsWhatASmallMotionChangesInThePicture) {
  const render::LossConfig loss = color_only();
  const render::TrainingImage here = view(SE3{});
  const Matrix6d information = pose_information(here, loss);
  EXPECT_LT((information - information.transpose()).norm(), 1e-9 * information.norm());
  const auto expect_change = [&](const Vector6d& xi) {
    const double expected = 0.5 * xi.dot(information * xi);
    const double actual = 0.5 * static_cast<double>(loss.color_weight / loss.color_knee) *
                          squared_difference(view(SE3::exp(xi)), here);
    EXPECT_NEAR(actual / expected, 1, 0.1) << xi.transpose();
  };
  for (int k = 0; k < 6; ++k) expect_change(0.02 * Vector6d::Unit(k));
  // Pitch and yaw move the wall like a shift across it: they add up or nearly cancel.
  for (const double sign : {-1.0, 1.0}) {
    expect_change(0.02 * (Vector6d::Unit(0) + sign * Vector6d::Unit(4)));
    expect_change(0.02 * (Vector6d::Unit(1) + sign * Vector6d::Unit(3)));
  }
}

TEST(KeyframeRefinement, DepthKnowsTheDistanceOfAWallAndItsTiltOnly) {
  render::LossConfig loss = color_only();
  loss.color_weight = 0;
  loss.depth_weight = 1;
  loss.depth_form = render::DepthForm::kAbsolute;
  const render::TrainingImage here = view(SE3{});
  const Matrix6d information = pose_information(here, loss);
  const double pixels = static_cast<double>(here.depth.size());
  // One per pixel over 2 cm; the frame's border is left out.
  EXPECT_NEAR(information(5, 5) / (pixels / 0.02), 1, 0.1);
  EXPECT_GT(information(0, 0), 0.02 * information(5, 5));
  EXPECT_GT(information(1, 1), 0.02 * information(5, 5));
  for (const int blind : {2, 3, 4}) {
    EXPECT_LT(information(blind, blind), 1e-4 * information(5, 5)) << blind;
  }
}

TEST(KeyframeRefinement, ColorWithoutDepthCountsAtTheMeanDepth) {
  render::TrainingImage image = view(SE3{});
  const Matrix6d whole = pose_information(image, color_only());
  for (int y = 0; y < image.depth.height(); ++y) {
    for (int x = 0; x < image.depth.width() / 2; ++x) image.depth(x, y) = 0;
  }
  EXPECT_LT((pose_information(image, color_only()) - whole).norm(), 1e-3 * whole.norm());
  image.depth = DepthImage(image.depth.width(), image.depth.height());
  EXPECT_EQ(pose_information(image, color_only()).norm(), 0);
}

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
