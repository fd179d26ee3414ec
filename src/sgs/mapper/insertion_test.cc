// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapper/insertion.h"

#include <gtest/gtest.h>

#include "sgs/mapper/test_wall_scene.h"

namespace sgs::mapper {
namespace {

struct Rendered {
  render::Rendering rendering;
  double covered = 0;      ///< share of pixels with alpha > 0.7
  double depth_error = 0;  ///< mean |D/A - z| of those
};

Rendered look(const map::GaussianStore& store, const RgbdFrame& frame, const SE3& T) {
  Rendered result;
  render::make_cpu_rasterizer(nullptr)->render(store.average, frame.camera, T, result.rendering);
  double count = 0;
  for (std::size_t i = 0; i < frame.depth.size(); ++i) {
    const float alpha = result.rendering.alpha.data()[i];
    if (alpha < 0.7f) continue;
    ++count;
    result.depth_error +=
        std::abs(result.rendering.depth_sum.data()[i] / alpha - frame.depth.data()[i]);
  }
  result.covered = count / static_cast<double>(frame.depth.size());
  result.depth_error /= std::max(1.0, count);
  return result;
}

TEST(QuadtreeInsertion, CoversAPlaneAtItsDepth) {
  const auto frame = wall_frame(small_camera(), SE3{});
  const MapKeyframe keyframe(*frame, SE3{}, 10);
  map::GaussianStore store;
  EXPECT_GT(insert_quadtree(keyframe, 0, nullptr, {}, 3, store), 50u);
  const Rendered seen = look(store, *frame, SE3{});
  EXPECT_GT(seen.covered, 0.95);
  EXPECT_LT(seen.depth_error, 0.02);
  for (const map::Anchor& anchor : store.anchors) {
    EXPECT_NEAR(anchor.point.z(), 2.0f, 1e-3f);
    EXPECT_GT(-anchor.normal.z(), 0.99f);
    EXPECT_EQ(anchor.keyframe, 0);
  }
}

TEST(QuadtreeInsertion, AddsNothingWhereTheMapExplainsTheView) {
  const auto frame = wall_frame(small_camera(), SE3{});
  const MapKeyframe keyframe(*frame, SE3{}, 10);
  map::GaussianStore store;
  const auto first = insert_quadtree(keyframe, 0, nullptr, {}, 3, store);
  const Rendered seen = look(store, *frame, SE3{});
  const auto second = insert_quadtree(keyframe, 1, &seen.rendering, {}, 3, store);
  EXPECT_LT(second, first / 20);
}

TEST(QuadtreeInsertion, AddsASurfaceInFrontOfTheMap) {
  const auto far = wall_frame(small_camera(), SE3{}, 0, 2.0);
  const auto near = wall_frame(small_camera(), SE3{}, 1, 1.5);
  map::GaussianStore store;
  insert_quadtree(MapKeyframe(*far, SE3{}, 10), 0, nullptr, {}, 3, store);
  const Rendered seen = look(store, *far, SE3{});
  EXPECT_GT(insert_quadtree(MapKeyframe(*near, SE3{}, 10), 1, &seen.rendering, {}, 3, store), 50u);
  EXPECT_LT(look(store, *near, SE3{}).depth_error, 0.1);
}

TEST(QuadtreeInsertion, ReachesTheBordersOfOddImages) {
  const PinholeCamera camera{150, 111, 140, 140, 75, 55};
  const auto frame = wall_frame(camera, SE3{});
  map::GaussianStore store;
  insert_quadtree(MapKeyframe(*frame, SE3{}, 10), 0, nullptr, {}, 3, store);
  EXPECT_GT(look(store, *frame, SE3{}).covered, 0.93);
}

TEST(QuadtreeInsertion, BorrowsDepthForHolesUnlessToldNotTo) {
  auto frame = wall_frame(small_camera(), SE3{});
  for (int v = 0; v < 120; ++v) {
    for (int u = 0; u < 40; ++u) frame->depth(u, v) = 0;
  }
  const MapKeyframe keyframe(*frame, SE3{}, 10);
  InsertionConfig config;
  map::GaussianStore with, without;
  insert_quadtree(keyframe, 0, nullptr, config, 3, with);
  config.fill_missing_depth = false;
  insert_quadtree(keyframe, 0, nullptr, config, 3, without);
  EXPECT_GT(with.size(), without.size() * 6 / 5);
}

TEST(GridInsertion, PlacesOneGaussianPerSampledPixel) {
  const auto frame = wall_frame(small_camera(), SE3{});
  InsertionConfig config = paper_mapper_config().insertion;
  config.grid_step_px = 20;  // at 640 pixels of width: 5 px here
  map::GaussianStore store;
  EXPECT_EQ(insert_grid(MapKeyframe(*frame, SE3{}, 10), 0, config, store), 32u * 24u);
  for (const map::Gaussian& g : store.raw) EXPECT_NEAR(g.mean[2], 2.0f, 1e-3f);
}

TEST(MapKeyframe, HalvesImagesWithoutMixingSurfaces) {
  auto frame = wall_frame(small_camera(), SE3{});
  frame->color(0, 0) = {100, 0, 0};
  frame->color(1, 0) = frame->color(0, 1) = frame->color(1, 1) = {0, 0, 0};
  frame->depth(0, 0) = frame->depth(1, 0) = 1.0f;
  frame->depth(0, 1) = frame->depth(1, 1) = 3.0f;
  frame->depth(2, 0) = 0;
  const auto image = MapKeyframe(*frame, SE3{}, 10).training_image(1).value();
  EXPECT_NEAR(image.color(0, 0).r, 25.0 / 255, 1e-6);
  EXPECT_EQ(image.depth(0, 0), 0.0f);
  EXPECT_NEAR(image.depth(1, 0), 2.0f, 1e-3f);
}

/// Only the right part of the picture was seen; the rest is garish.
std::shared_ptr<RgbdFrame> half_seen_wall(int first_seen, bool deep) {
  auto frame = wall_frame(small_camera(), SE3{});
  auto seen = std::make_shared<PixelMask>(160, 120, std::uint8_t{1});
  for (int v = 0; v < 120; ++v) {
    for (int u = 0; u < first_seen; ++u) {
      (*seen)(u, v) = 0;
      frame->color(u, v) = {255, 0, 255};
      if (!deep) frame->depth(u, v) = 0;
    }
  }
  frame->seen = seen;
  return frame;
}

TEST(QuadtreeInsertion, NoGaussianIsBornOfWhatWasNotSeen) {
  for (const bool deep : {false, true}) {
    const int first_seen = 43;
    const auto frame = half_seen_wall(first_seen, deep);
    const MapKeyframe keyframe(*frame, SE3{}, 10);
    map::GaussianStore store;
    EXPECT_GT(insert_quadtree(keyframe, 0, nullptr, {}, 3, store), 50u);
    for (const map::Gaussian& g : store.raw) {
      const Eigen::Vector3d p(g.mean[0], g.mean[1], g.mean[2]);
      EXPECT_GE(small_camera().project(p).x(), first_seen);
      EXPECT_GT(g.rgb[1], 0.05f);  // nothing of the purple
    }
  }
}

TEST(GridInsertion, NoGaussianIsBornOfWhatWasNotSeen) {
  const auto frame = half_seen_wall(43, true);
  InsertionConfig config = paper_mapper_config().insertion;
  config.grid_step_px = 20;
  map::GaussianStore store;
  insert_grid(MapKeyframe(*frame, SE3{}, 10), 0, config, store);
  ASSERT_GT(store.raw.size(), 100u);
  for (const map::Gaussian& g : store.raw) {
    EXPECT_GE(small_camera().project({g.mean[0], g.mean[1], g.mean[2]}).x(), 43 - 0.5);
  }
}

TEST(MapKeyframe, TrainingImagesSayWhatWasNotSeen) {
  const auto frame = half_seen_wall(43, true);
  const MapKeyframe keyframe(*frame, SE3{}, 10);
  const auto full = keyframe.training_image(0).value();
  const auto half = keyframe.training_image(1).value();
  for (int v = 0; v < 120; ++v) {
    for (int u = 0; u < 160; ++u) {
      ASSERT_EQ(full.depth(u, v) == render::TrainingImage::kUnseen, u < 43) << u << " " << v;
    }
  }
  for (int v = 0; v < 60; ++v) {
    for (int u = 0; u < 80; ++u) {
      ASSERT_EQ(half.depth(u, v) == render::TrainingImage::kUnseen, u < 22) << u << " " << v;
    }
  }
}

}  // namespace
}  // namespace sgs::mapper
