// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/alignment/movers/moving_parts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "sgs/alignment/movers/rigid_fit.h"
#include "sgs/alignment/movers/surface_check.h"
#include "sgs/alignment/test_textured_wall.h"
#include "sgs/camera/depth_noise.h"

namespace sgs::alignment {
namespace {

// A board that is carried through the view before the papered wall; papered as well.
struct Board {
  double left_m, width_m, distance_m;
};

RgbdFrame see(const SE3& T_world_camera, int index, const Board& board) {
  RgbdFrame frame = see_wall(T_world_camera, index);
  for (int v = 0; v < kWallCamera.height; ++v) {
    for (int u = 0; u < kWallCamera.width; ++u) {
      const Eigen::Vector3d ray = T_world_camera.R * kWallCamera.back_project(u, v, 1.0);
      const double z = (board.distance_m - T_world_camera.t.z()) / ray.z();
      const Eigen::Vector3d p = T_world_camera.t + z * ray;
      const double x = p.x() - board.left_m;
      if (x < 0 || x > board.width_m) continue;
      const std::uint8_t grey = wallpaper(x + 7, p.y());
      frame.color(u, v) = {grey, grey, grey};
      frame.depth(u, v) = static_cast<float>(z);
    }
  }
  return frame;
}

// Past the camera at a metre a second.
Board carried(int index, double width_m) { return {-0.5 + index / 30.0, width_m, 0.8}; }

CoarseDepth coarse(int index, const Board& board, const SE3& T = {}) {
  return CoarseDepth(see(T, index, board));
}

TEST(CoarseDepth, KeepsPixelsWithTheirCamera) {
  const RgbdFrame frame = see_wall({}, 3);
  const CoarseDepth depth(frame);
  EXPECT_EQ(depth.frame, 3);
  ASSERT_EQ(depth.step_px, 2);
  EXPECT_EQ(depth.depth.width(), kWallCamera.width / 2);
  const Eigen::Vector3d there = depth.camera.back_project(5, 7, 1.0);
  const Eigen::Vector3d here = kWallCamera.back_project(11, 15, 1.0);
  EXPECT_NEAR((there - here).norm(), 0, 1e-12);
  EXPECT_EQ(depth.depth(5, 7), frame.depth(11, 15));
}

TEST(MovingParts, BelievesWhatItIsTold) {
  MovingParts parts;
  parts.look_at(see_wall({}, 0));
  EXPECT_FALSE(parts.told({}).mask.any());
  EXPECT_TRUE(parts.told({}).still.empty());
  std::vector<std::uint8_t> cells(40 * 30, 0);
  for (int row = 10; row < 20; ++row) {
    for (int column = 5; column < 15; ++column)
      cells[static_cast<std::size_t>(row * 40 + column)] = 1;
  }
  const registration::CellMask moving(8, 40, std::move(cells));
  const MovingParts::Judgement told = parts.told(moving);
  ASSERT_EQ(told.still.size(), 80u * 60u);
  EXPECT_EQ(told.mask.cells(), moving.cells());
  EXPECT_EQ(told.still[30 * 80 + 20], 0);  // in the middle
  EXPECT_EQ(told.still[30 * 80 + 11], 1);  // at its edge
  EXPECT_EQ(told.still[30 * 80 + 50], 1);
  EXPECT_FALSE(parts.moved());
  parts.remember(told, {});
  EXPECT_TRUE(parts.moved());
}

TEST(SurfaceCheck, SurfaceIsOffWhereNothingStoodAndUnknownWhereItWasHidden) {
  const Board nobody{10, 0.1, 0.8};
  const CoarseDepth empty = coarse(0, nobody), with = coarse(1, {-0.1, 0.2, 0.8});
  const SurfaceCheck came = check_surface(with, empty, {}), left = check_surface(empty, with, {});
  const auto middle = came.off.size() / 2 + static_cast<std::size_t>(came.columns / 2);
  EXPECT_EQ(came.off[middle], 1);
  EXPECT_EQ(left.off[middle], SurfaceCheck::kUnknown);
  const auto beside = middle + 15;
  EXPECT_LT(came.off[beside], 0.1f);
  EXPECT_LT(left.off[beside], 0.1f);
  EXPECT_GT(check_surface(empty, empty, {}).support, came.support);
}

TEST(SurfaceCheck, FollowsTheCamera) {
  const Board nobody{10, 0.1, 0.8};
  const SE3 T(so3_exp({0.02, 0.05, 0.1}), {0.03, 0.02, -0.2});
  const SurfaceCheck check = check_surface(coarse(1, nobody, T), coarse(0, nobody), T);
  for (const float off : check.off) EXPECT_LT(off, 0.1f);
  const SurfaceCheck wrong = check_surface(coarse(1, nobody, T), coarse(0, nobody), {});
  EXPECT_LT(wrong.support, 0.2 * check.support);
}

TEST(SurfaceCheck, FollowsACameraThatMovesWhileItIsReadOut) {
  const Board nobody{10, 0.1, 0.8};
  Vector6d delta = Vector6d::Zero();
  delta << 0.04, 0.02, 0, 0, 0, 0.03;
  RgbdFrame frame = see({}, 1, nobody);
  for (int v = 0; v < kWallCamera.height; ++v) {
    const float o = registration::ReadoutMotion::offset(static_cast<float>(v), kWallCamera.height);
    const RgbdFrame there = see(SE3::exp(double{o} * delta), 1, nobody);
    std::copy_n(there.depth.row(v), kWallCamera.width, frame.depth.row(v));
  }
  CoarseDepth now(frame);
  const CoarseDepth then = coarse(0, nobody);
  const double unaware = check_surface(now, then, {}).support;
  now.motion.readout = delta;
  const SurfaceCheck aware = check_surface(now, then, {}), back = check_surface(then, now, {});
  for (const float off : aware.off) EXPECT_LT(off, 0.1f);
  for (const float off : back.off) EXPECT_LT(off, 0.1f);
  EXPECT_LT(unaware, 0.9 * aware.support);
  EXPECT_LT((fit_rigid(now, then, {}).log()).norm(), 2e-3);
}

TEST(SurfaceCheck, SomethingStandsBeforeAWallThatIsNoLongerMeasured) {
  const auto without = [](int left_px, int width_px, int index) {
    RgbdFrame frame = see({}, index, {10, 0.1, 0.8});
    for (int v = 0; v < kWallCamera.height; ++v) {
      std::fill_n(frame.depth.row(v) + left_px, width_px, 0.0f);
    }
    return CoarseDepth(frame);
  };
  const CoarseDepth whole = without(0, 0, 0), hole = without(100, 80, 1), rim = without(100, 80, 2);
  const auto covered = [](const CoarseDepth& now, const CoarseDepth& then) {
    std::vector<float> off = check_surface(now, then, {}).off;
    check_covered(now, then, {}, nearest_measured(now), off);
    return off;
  };
  const std::vector<float> came = covered(hole, whole);
  const int columns = hole.depth.width() / SurfaceCheck::kCell;
  const auto cell = [&](int u) { return static_cast<std::size_t>(30 * columns + u / 4); };
  EXPECT_EQ(came[cell(140)], 1);
  EXPECT_LT(came[cell(40)], 0.1f);
  EXPECT_EQ(covered(rim, hole)[cell(140)], SurfaceCheck::kUnknown);  // it never is
}

TEST(RigidFit, FollowsTheRoomAndNotWhoMovesInIt) {
  const SE3 truth(so3_exp({0.01, 0.01, 0.05}), {0.03, 0.02, -0.02});
  const CoarseDepth then = coarse(0, {-0.3, 0.5, 0.8}), now = coarse(1, {-0.25, 0.5, 0.75}, truth);
  const SE3 fitted = fit_rigid(now, then, truth * SE3(so3_exp({0, 0, 0}), {0, 0, 0.01}));
  EXPECT_NEAR(fitted.t.z(), truth.t.z(), 1e-3);  // all else is free in front of a wall
}

// Depth that errs by so many widths of what its model says, by pixel and frame.
void disturb(RgbdFrame& frame, double widths) {
  std::mt19937 random(static_cast<unsigned>(frame.index));
  for (int v = 0; v < frame.depth.height(); ++v) {
    for (int u = 0; u < frame.depth.width(); ++u) {
      float& z = frame.depth(u, v);
      const double unit = static_cast<double>(random()) / 4294967296.0;
      z += static_cast<float>((unit - 0.5) * std::sqrt(12.0) * widths) * depth_sigma_m(z);
    }
  }
}

// Looks at frames up to the last, of which it gives the judgement; all from one place. The last
// pose is told wrong by so much.
MovingParts::Judgement judge_last(int last, double width_m, double wrong_m = 0,
                                  double noise_widths = 0) {
  MovingParts parts;
  history::Revision revision;
  LocalPast past;
  MovingParts::Judgement judgement;
  for (int i = 0; i <= last; ++i) {
    RgbdFrame frame = see({}, i, carried(i, width_m));
    disturb(frame, noise_widths);
    parts.look_at(frame);
    const SE3 told(so3_exp({0, 0, 0}), {0, 0, i == last ? wrong_m : 0});
    judgement = parts.judge(told, {}, past);
    revision.path.append({i, i / 30.0, SE3{}});
    past.set_revision(revision);
    parts.remember(judgement, {});
  }
  return judgement;
}

TEST(MovingParts, SaysWhatIsCarriedThroughTheView) {
  const MovingParts::Judgement judgement = judge_last(15, 0.5);
  ASSERT_TRUE(judgement.mask.any());
  const RgbdFrame frame = see({}, 15, carried(15, 0.5));
  int both = 0, either = 0;
  for (int v = 4; v < kWallCamera.height; v += 8) {
    for (int u = 4; u < kWallCamera.width; u += 8) {
      const bool moves = frame.depth(u, v) < 1, said = judgement.mask.at(u, v);
      both += moves && said ? 1 : 0;
      either += moves || said ? 1 : 0;
    }
  }
  EXPECT_GT(both, 0.8 * either);
}

TEST(MovingParts, LearnsThatDepthIsNoisierThanItsModel) {
  const MovingParts::Judgement judgement = judge_last(25, 0.5, 0, 8);
  const RgbdFrame frame = see({}, 25, carried(25, 0.5));
  int still = 0, said = 0;
  for (int v = 4; v < kWallCamera.height; v += 8) {
    for (int u = 4; u < kWallCamera.width; u += 8) {
      if (frame.depth(u, v) < 1) continue;
      ++still;
      said += judgement.mask.at(u, v) ? 1 : 0;
    }
  }
  EXPECT_LT(said, 0.15 * still);
}

TEST(MovingParts, SaysNothingOfSomethingSmall) { EXPECT_FALSE(judge_last(15, 0.1).mask.any()); }

TEST(MovingParts, SaysNothingWhereThePoseIsWrong) {
  constexpr double kWrong_m = 0.04;
  EXPECT_FALSE(judge_last(15, 0.1, kWrong_m).mask.any());
  EXPECT_FALSE(judge_last(15, 0.1, -kWrong_m).mask.any());
}

}  // namespace
}  // namespace sgs::alignment
