// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <future>
#include <new>
#include <utility>

#include "sgs/camera/movers.h"
#include "sgs/viewer/board.h"
#include "sgs/viewer/panes.h"
#include "sgs/viewer/picture_service.h"
#include "sgs/viewer/session_feed.h"
#include "sgs/viewer/test_update.h"

namespace sgs::viewer {
namespace {

TEST(Panes, ShrinkingTakesMeansOfColourAndSamplesOfDepth) {
  ColorImage color(4, 3);
  color(0, 0) = {100, 0, 0};
  color(1, 1) = {50, 0, 1};
  const ColorImage small = shrink(color, 2);
  EXPECT_EQ(small.width(), 2);
  EXPECT_EQ(small.height(), 1);
  EXPECT_EQ(small(0, 0), (Rgb8{38, 0, 0}));
  DepthImage depth(4, 4, 0.0f);
  depth(2, 0) = 3;
  depth(3, 0) = 9;
  EXPECT_EQ(shrink(depth, 2)(1, 0), 3);
}

TEST(Panes, DepthGetsDarkerWithDistanceAndHolesAreBlack) {
  DepthImage depth(4, 1);
  depth(1, 0) = 0.5f;
  depth(2, 0) = 2;
  depth(3, 0) = 50;
  const ColorImage picture = depth_picture(depth);
  EXPECT_EQ(picture(0, 0), (Rgb8{}));
  EXPECT_GT(luma(picture(1, 0)), luma(picture(2, 0)) + 30);
  EXPECT_GT(luma(picture(2, 0)), luma(picture(3, 0)) + 30);
  EXPECT_GT(luma(picture(3, 0)), 5);
}

TEST(Panes, ErrorIsBlackWhereEqual) {
  ColorImage a(2, 1, {10, 20, 30}), b = a;
  b(1, 0) = {255, 255, 255};
  const ColorImage error = error_picture(a, b);
  EXPECT_EQ(error(0, 0), (Rgb8{}));
  EXPECT_EQ(error(1, 0).r, 255);
  EXPECT_THROW(error_picture(a, ColorImage(1, 1)), ContractViolation);
}

TEST(Panes, AnOutlineGoesAroundWhatMoves) {
  ColorImage image(20, 16, {90, 90, 90});
  PixelMask still(20, 16, std::uint8_t{1});
  for (int v = 0; v < 12; ++v) {
    for (int u = 5; u < 15; ++u) still(u, v) = 0;
  }
  outline(image, still);
  const auto is_drawn = [&](int u, int v) { return image(u, v) != Rgb8{90, 90, 90}; };
  EXPECT_TRUE(is_drawn(5, 6) && is_drawn(6, 6) && is_drawn(14, 6) && is_drawn(10, 11));
  EXPECT_FALSE(is_drawn(4, 6) || is_drawn(7, 6) || is_drawn(10, 12) || is_drawn(10, 5));
  EXPECT_FALSE(is_drawn(10, 0)) << "the rim of the picture is no border of what moves";
  EXPECT_THROW(outline(image, PixelMask(19, 16)), ContractViolation);
}

/// A map in front of the camera and the frame that goes with it.
FrameUpdatePtr scene(std::int64_t index) {
  auto map = testing::snapshot(1, {0, 1, 2});
  for (auto& g : map->gaussians) {
    g.mean[0] = 0.2f * (g.mean[0] - 1);
    g.mean[2] = 2;
  }
  FrameUpdate u = testing::update(index, map);
  u.T_world_camera = SE3();
  RgbdFrame frame;
  frame.index = index;
  frame.camera = {64, 48, 60, 60, 31.5, 23.5};
  frame.color = ColorImage(64, 48, {90, 90, 90});
  frame.depth = DepthImage(64, 48, 2.0f);
  u.frame = std::make_shared<const RgbdFrame>(std::move(frame));
  return std::make_shared<const FrameUpdate>(std::move(u));
}

/// Collects what a service makes.
struct Gallery {
  std::mutex mutex;
  std::condition_variable changed;
  std::vector<Picture> pictures;

  PictureService::Deliver deliver() {
    return [this](Picture p) {
      const std::scoped_lock lock(mutex);
      pictures.push_back(std::move(p));
      changed.notify_all();
    };
  }
  bool wait_for(std::size_t count) {
    std::unique_lock lock(mutex);
    return changed.wait_for(lock, std::chrono::seconds(60),
                            [&] { return pictures.size() >= count; });
  }
};

TEST(PictureService, MakesTheWantedPanesOfTheNewestFrameOnce) {
  Gallery gallery;
  PictureService service({64, 48, 60, 60, 31.5, 23.5}, gallery.deliver());
  service.offer(scene(4));
  service.offer(scene(5));
  service.set_panes(bit(Pane::kColor) | bit(Pane::kRender) | bit(Pane::kError));
  ASSERT_TRUE(gallery.wait_for(3));
  service.set_panes(bit(Pane::kColor) | bit(Pane::kRender) | bit(Pane::kError) | bit(Pane::kDepth));
  ASSERT_TRUE(gallery.wait_for(4));
  const std::scoped_lock lock(gallery.mutex);
  std::vector<Pane> panes;
  for (const Picture& p : gallery.pictures) {
    panes.push_back(p.pane);
    EXPECT_EQ((*p.message)[1], static_cast<char>(p.pane));
    EXPECT_EQ((*p.message)[4], 5);                   // frame
    EXPECT_EQ(p.message->substr(8, 2), "\xff\xd8");  // JPEG
  }
  EXPECT_THAT(panes,
              ::testing::ElementsAre(Pane::kColor, Pane::kRender, Pane::kError, Pane::kDepth));
}

// In the colour pane, and in no other.
TEST(PictureService, OutlinesWhatMoves) {
  const auto pictures_of = [](const std::string& movers) {
    auto update = std::make_shared<FrameUpdate>(*scene(5));
    update->record.movers = movers;
    Gallery gallery;
    PictureService service({64, 48, 60, 60, 31.5, 23.5}, gallery.deliver());
    service.offer(std::move(update));
    service.set_panes(bit(Pane::kColor) | bit(Pane::kError));
    EXPECT_TRUE(gallery.wait_for(2));
    const std::scoped_lock lock(gallery.mutex);
    return std::pair(*gallery.pictures[0].message, *gallery.pictures[1].message);
  };
  PixelMask still(64, 48, std::uint8_t{1});
  still(30, 20) = 0;
  const auto nobody = pictures_of(""), somebody = pictures_of(mover_blocks(still));
  EXPECT_NE(nobody.first, somebody.first);
  EXPECT_EQ(nobody.second, somebody.second);
  EXPECT_EQ(pictures_of("of another size").first, nobody.first);
}

TEST(PictureService, WhatAPictureThrowsCostsThatPictureOnly) {
  Gallery gallery;
  bool thrown = false;
  PictureService service({64, 48, 60, 60, 31.5, 23.5},
                         [&, deliver = gallery.deliver()](const Picture& p) {
                           if (!std::exchange(thrown, true)) throw std::bad_alloc();
                           deliver(p);
                         });
  service.offer(scene(0));
  service.request_view(7, {1, SE3(), 1.0, 80, 60});
  service.request_view(8, {1, SE3(), 1.0, 80, 60});
  ASSERT_TRUE(gallery.wait_for(1));
}

TEST(PictureService, RendersTheNewestViewOfEachClient) {
  Gallery gallery;
  PictureService service({64, 48, 60, 60, 31.5, 23.5}, gallery.deliver());
  ViewRequest request{1, SE3(), 1.0, 80, 60};
  service.request_view(7, request);
  request.sequence = 2;
  service.request_view(7, request);
  service.request_view(8, request);
  service.request_view(9, request);
  service.forget(8);
  service.offer(scene(0));  // requests wait for the first map
  ASSERT_TRUE(gallery.wait_for(2));
  const std::scoped_lock lock(gallery.mutex);
  EXPECT_EQ(gallery.pictures[0].client, 7u);
  EXPECT_EQ((*gallery.pictures[0].message)[4], 2);
  EXPECT_EQ(gallery.pictures[1].client, 9u);
}

TEST(Board, AFrameNumberThatNoCameraGivesFillsNoMemory) {
  Board board;
  board.post(std::make_shared<FrameUpdate>(testing::update(0)));
  board.post(std::make_shared<FrameUpdate>(testing::update(std::int64_t{1} << 60)));
  board.post(std::make_shared<FrameUpdate>(testing::update(2)));
  EXPECT_EQ(board.path(0, 10).size(), 3u);
}

TEST(SessionFeed, PosesFollowTheRefinementOfTheNewestKeyframe) {
  history::Path path;
  for (int i = 0; i < 3; ++i) {
    path.append({10 + i, 0, SE3(Eigen::Matrix3d::Identity(), {1. * i, 0, 0})});
  }
  const SE3 newest = path.back().T_odom_camera;
  auto map = std::make_shared<map::Snapshot>();
  EXPECT_EQ(pose_in_map(newest, path, nullptr).t.x(), 2);
  EXPECT_EQ(pose_in_map(newest, path, map).t.x(), 2);
  map->keyframe_frames = {11};
  map->T_world_keyframe = {SE3(so3_exp({0, 0, 0.1}), {5, 0, 0})};
  const SE3 moved = pose_in_map(newest, path, map);
  EXPECT_LT((moved.t - Eigen::Vector3d(5 + std::cos(0.1), std::sin(0.1), 0)).norm(), 1e-12);
  map->keyframe_frames = {99};  // unknown
  EXPECT_EQ(pose_in_map(newest, path, map).t.x(), 2);
}

}  // namespace
}  // namespace sgs::viewer
