// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "sgs/camera/register_depth.h"
#include "sgs/synthetic/source.h"

namespace sgs {
namespace {

// A depth camera 5 cm beside the colour camera, a little turned, coarser: brought into the colour
// camera, its depth must be what the colour camera's own ray caster sees.
TEST(RegisteredDepth, OfARenderedRoomIsTheColourCamerasOwnDepth) {
  synthetic::SynthOptions options;
  options.scene = "room_desk";
  const auto scene = synthetic::make_scene(options);
  const auto motion = synthetic::handheld_trajectory(options);
  ASSERT_TRUE(scene && motion);
  const PinholeCamera color{320, 240, 268, 270, 160, 124}, depth{280, 210, 210, 212, 141, 104};
  const SE3 T_color_depth(so3_exp({0.004, -0.01, 0.008}), {0.05, 0.002, -0.003});
  const DepthRegistration registration({depth, {}}, {color, {}}, T_color_depth);
  ThreadPool pool(2);
  for (const std::size_t at : {std::size_t{0}, motion->size() / 2}) {
    const SE3 T_world_color = motion->poses()[at].T_world_camera;
    const DepthImage truth = render_exact(**scene, color, T_world_color, pool).depth;
    const DepthImage seen = render_exact(**scene, depth, T_world_color * T_color_depth, pool).depth;
    const DepthImage out = registration(seen);
    std::size_t missing = 0, wrong = 0, compared = 0;
    std::vector<double> errors;
    for (int v = 12; v < color.height - 12; ++v) {
      for (int u = 40; u < color.width - 40; ++u) {
        if (truth(u, v) == 0) continue;
        ++compared;
        if (out(u, v) == 0) {
          ++missing;
          continue;
        }
        errors.push_back(std::abs(out(u, v) - truth(u, v)) / truth(u, v));
        wrong += errors.back() > 0.05;
      }
    }
    ASSERT_GT(compared, 30000u);
    std::nth_element(errors.begin(), errors.begin() + errors.size() / 2, errors.end());
    EXPECT_LT(errors[errors.size() / 2], 0.002);
    // Only silhouettes differ, and only what is hidden from the depth camera is missing.
    EXPECT_LT(wrong, compared / 50);
    EXPECT_LT(missing, compared / 25);
  }
}

}  // namespace
}  // namespace sgs
