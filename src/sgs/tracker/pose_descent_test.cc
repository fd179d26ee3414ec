// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/tracker/pose_descent.h"

#include <gtest/gtest.h>

#include "sgs/render/rendered_images.h"
#include "sgs/tracker/test_wall_map.h"

namespace sgs::tracker {
namespace {

class PoseDescentTest : public testing::TestWithParam<RenderMethod> {
 protected:
  PoseDescentTest() : rasterizer_(render::make_cpu_rasterizer(nullptr)) {
    config_.method = GetParam();
  }
  SE3 descend(const map::Snapshot& map, const RgbdFrame& frame, const SE3& T_start) {
    return PoseDescent(config_, *rasterizer_).descend(map.gaussians, frame, T_start);
  }

  /// The frame that the map itself would give.
  RgbdFrame see(const map::Snapshot& map, const SE3& T) {
    render::Rendering rendering;
    rasterizer_->render(map.gaussians, alignment::kWallCamera, T, rendering);
    RgbdFrame frame;
    frame.camera = alignment::kWallCamera;
    frame.color = render::to_color_image(rendering.color);
    frame.depth = render::mean_depth(rendering, 0.5f);
    return frame;
  }

  RenderingConfig config_;
  std::unique_ptr<render::Rasterizer> rasterizer_;
};
INSTANTIATE_TEST_SUITE_P(Method, PoseDescentTest,
                         testing::Values(RenderMethod::kGaussNewton, RenderMethod::kAdam),
                         [](const auto& method) { return to_string(method.param); });

/// The papered wall with tiles that stand out by different heights: where tiles overlap in one
/// plane their order, and with it the picture, changes with every motion.
map::Snapshot relief() {
  map::Snapshot wall = *wall_map();
  for (std::size_t i = 0; i < wall.gaussians.size(); ++i) {
    wall.gaussians[i].mean[2] -= 0.01f * static_cast<float>(i * 2654435761U % 7);
  }
  return wall;
}

SE3 moved(const SE3& T) {
  Vector6d xi;
  xi << 0.003, -0.004, 0.005, 0.008, -0.006, 0.01;
  return T * SE3::exp(xi);
}

double distance(const SE3& a, const SE3& b) { return (a.inverse() * b).log().norm(); }

TEST_P(PoseDescentTest, ComesBackToWhereTheFrameWasTaken) {
  const SE3 T_true = alignment::wall_pose(0), T_start = moved(T_true);
  const map::Snapshot map = relief();
  const SE3 T = descend(map, see(map, T_true), T_start);
  EXPECT_LT(distance(T, T_true), 0.35 * distance(T_start, T_true));
}

TEST_P(PoseDescentTest, StaysWhereTheMapExplainsNothing) {
  const SE3 T_start = moved(alignment::wall_pose(0));
  const RgbdFrame frame = alignment::see_wall(alignment::wall_pose(0), 0);
  EXPECT_EQ(descend(map::Snapshot{}, frame, T_start).t, T_start.t);
  map::Snapshot behind = *wall_map();
  for (map::Gaussian& g : behind.gaussians) g.mean[2] -= 50;
  EXPECT_EQ(descend(behind, frame, T_start).t, T_start.t);
}

TEST_P(PoseDescentTest, StaysWhereNoDepthWasMeasured) {
  RgbdFrame frame = alignment::see_wall(alignment::wall_pose(0), 0);
  frame.depth = DepthImage(frame.depth.width(), frame.depth.height());
  const SE3 T_start = moved(alignment::wall_pose(0));
  EXPECT_EQ(descend(*wall_map(), frame, T_start).t, T_start.t);
}

TEST_P(PoseDescentTest, IsFiniteWithAMapThatIsNot) {
  map::Snapshot broken = *wall_map();
  for (std::size_t i = 0; i < broken.gaussians.size(); i += 7) broken.gaussians[i].rgb[0] = NAN;
  const SE3 T = descend(broken, alignment::see_wall(alignment::wall_pose(0), 0),
                        moved(alignment::wall_pose(0)));
  EXPECT_TRUE(T.all_finite());
}

}  // namespace
}  // namespace sgs::tracker
