// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/tracker/spectral_tracker.h"

#include <gtest/gtest.h>

#include "sgs/alignment/test_textured_wall.h"
#include "sgs/tracker/test_tracker.h"

namespace sgs::tracker {
namespace {

double distance_m(const SE3& a, const SE3& b) { return (a.t - b.t).norm(); }

struct WallRun {
  std::vector<TrackResult> results;
  double worst_m = 0;
  int lost = 0;
};

WallRun run_wall(const TrackerConfig& config, int frames, const SE3& T_shift = {}) {
  WallRun run;
  const auto tracker = must_make(config, alignment::kWallCamera, T_shift * alignment::wall_pose(0));
  for (int i = 0; i < frames; ++i) {
    run.results.push_back(tracker->track(alignment::see_wall(alignment::wall_pose(i), i), nullptr));
    const TrackResult& r = run.results.back();
    run.worst_m =
        std::max(run.worst_m, distance_m(r.T_odom_camera, T_shift * alignment::wall_pose(i)));
    run.lost += r.status == TrackingStatus::kLost ? 1 : 0;
  }
  return run;
}

TEST(SpectralTracker, HoldsOnToAPaperedWallWhereGeometrySlides) {
  TrackerConfig config;
  const WallRun spectral = run_wall(config, 40);
  EXPECT_EQ(spectral.lost, 0);
  EXPECT_LT(spectral.worst_m, 0.01);
  for (std::size_t i = 1; i < spectral.results.size(); ++i) {
    const Diagnostics& d = spectral.results[i].diagnostics;
    EXPECT_EQ(spectral.results[i].status, TrackingStatus::kDegenerate) << i;
    EXPECT_TRUE(d.prior_active);
    EXPECT_EQ(d.prior_source, PriorSource::kPhotometric);
    // A plane leaves two translations and the rotation about its normal open.
    EXPECT_EQ(__builtin_popcount(d.degenerate_mask), 3) << i;
    EXPECT_GT(d.planarity, 0.9);
  }
  config.type = TrackerType::kGicp;
  EXPECT_GT(run_wall(config, 40).worst_m, 0.1);
}

// A camera that goes to and fro before the wall, at up to half a metre a second, and turns. It
// begins at rest: the motion of the first frame is not known.
SE3 swinging(double t_s, double haste = 1) {
  const auto swing = [&](double rate) {
    return (1 - std::cos(haste * rate * t_s)) / haste;  // as fast, and turns round as often
  };
  return SE3(so3_exp({0.04 * swing(5), 0.05 * swing(4), 0}), {0.1 * swing(3), 0, 0.1 * swing(5)});
}

// Root mean square error of the path where depth comes late, in metres.
double error_with_depth_later_by(double delay_s, double known_delay_s, bool learn,
                                 double haste = 1) {
  constexpr int kFrames = 40;
  TrackerConfig config;
  config.delay.estimate = learn;
  const auto tracker = must_make(config, alignment::kWallCamera, swinging(0, haste));
  double squares = 0;
  for (int i = 0; i < kFrames; ++i) {
    RgbdFrame frame = alignment::see_wall(swinging(i / 30.0, haste), i);
    frame.depth = alignment::see_wall(swinging(i / 30.0 + delay_s, haste), i).depth;
    frame.depth_delay_s = known_delay_s;
    const TrackResult result = tracker->track(frame, nullptr);
    EXPECT_NE(result.status, TrackingStatus::kLost) << i;
    const double error = distance_m(result.T_odom_camera, swinging(i / 30.0, haste));
    squares += error * error / kFrames;
  }
  return std::sqrt(squares);
}

TEST(SpectralTracker, DepthThatIsKnownToComeLateIsTakenForWhenItWas) {
  const double late_m = error_with_depth_later_by(0.008, 0, false);
  EXPECT_LT(error_with_depth_later_by(0.008, 0.008, false), 0.4 * late_m);
  // Learning what its stamps leave open does no harm, and does where they say nothing.
  EXPECT_LT(error_with_depth_later_by(0.008, 0.008, true), 0.5 * late_m);
  EXPECT_LT(error_with_depth_later_by(0.008, 0, true), 0.5 * late_m);
}

// Of a hand that turns round ten times a second the last frames say nothing.
TEST(SpectralTracker, LateDepthFollowsAHandThatTurnsRoundQuickly) {
  constexpr double kHaste = 4;
  const double late_m = error_with_depth_later_by(0.015, 0, false, kHaste);
  EXPECT_LT(error_with_depth_later_by(0.015, 0.015, false, kHaste), 0.5 * late_m);
}

TEST(SpectralTracker, DoesNotDependOnTheWorldOrigin) {
  SE3 shift(so3_exp({0.3, -1.0, 0.5}), {100, -100, 50});
  const WallRun here = run_wall({}, 12), there = run_wall({}, 12, shift);
  for (std::size_t i = 0; i < here.results.size(); ++i) {
    EXPECT_EQ(here.results[i].diagnostics.degenerate_mask,
              there.results[i].diagnostics.degenerate_mask);
    EXPECT_LT(distance_m(shift * here.results[i].T_odom_camera, there.results[i].T_odom_camera),
              1e-6);
  }
}

TEST(SpectralTracker, GivesTheSameBitsAgain) {
  const WallRun a = run_wall({}, 10), b = run_wall({}, 10);
  for (std::size_t i = 0; i < a.results.size(); ++i) {
    EXPECT_EQ(a.results[i].T_odom_camera.t, b.results[i].T_odom_camera.t);
    EXPECT_EQ(a.results[i].T_odom_camera.R, b.results[i].T_odom_camera.R);
  }
}

TEST(SpectralTracker, SaysLostBeforeABarePlaneAndComesBack) {
  const auto tracker = must_make({}, alignment::kWallCamera, alignment::wall_pose(0));
  for (int i = 0; i < 12; ++i)
    tracker->track(alignment::see_wall(alignment::wall_pose(i), i), nullptr);
  // The camera stops before a wall without paper: neither source sees the two sideways directions.
  int lost = 0;
  SE3 last;
  for (int i = 12; i < 42; ++i) {
    const auto r = tracker->track(alignment::see_wall(alignment::wall_pose(11), i, false), nullptr);
    lost += r.status == TrackingStatus::kLost ? 1 : 0;
    EXPECT_LT(distance_m(r.T_odom_camera, alignment::wall_pose(11)), 0.15) << i;
    last = r.T_odom_camera;
  }
  EXPECT_GE(lost, 29);
  // Features return: tracking is back within half a second, where it was.
  TrackResult r;
  for (int i = 42; i < 57; ++i)
    r = tracker->track(alignment::see_wall(alignment::wall_pose(i - 31), i), nullptr);
  EXPECT_NE(r.status, TrackingStatus::kLost);
  EXPECT_LT(distance_m(r.T_odom_camera, alignment::wall_pose(25)), 0.015);
}

// After its first frame, and later: keyframes, targets and the motion are where the path has them.
TEST(SpectralTracker, GoesOnWhereARevisionPutsIt) {
  const SE3 shift(so3_exp({0.02, 0.3, -0.1}), {1, -2, 0.5});
  for (const int frames : {1, 12}) {
    const auto tracker = must_make({}, alignment::kWallCamera, alignment::wall_pose(0));
    for (int i = 0; i < frames; ++i)
      tracker->track(alignment::see_wall(alignment::wall_pose(i), i), nullptr);
    const history::Path::Entry last = tracker->revision().path.back();
    const SE3& T = last.T_odom_camera;
    tracker->revise({PoseCorrection({{last.timestamp_s, T, shift * T}})});
    for (int i = frames; i < frames + 3; ++i) {
      const TrackResult r =
          tracker->track(alignment::see_wall(alignment::wall_pose(i), i), nullptr);
      EXPECT_NE(r.status, TrackingStatus::kLost) << i;
      EXPECT_LT(distance_m(r.T_odom_camera, shift * alignment::wall_pose(i)), 0.01) << i;
    }
  }
}

// A camera that has drifted on its way back sees old keyframes beside where they are held to be;
// the newest one fits as ever.
TEST(SpectralTracker, LeavesOutAnOldKeyframeThatContradictsTheNewestOneAtOnce) {
  constexpr int kStands = 13, kDrifted = 25, kFrames = 35;
  const auto along_wall = [&](int i) {
    return SE3(so3_exp({0.03, -0.02, 0.01}), {0.03 * std::min(i, kStands), 0, 0});
  };
  const auto tracker = must_make({}, alignment::kWallCamera, along_wall(0));
  for (int i = 0; i < kFrames; ++i) {
    if (i == kDrifted) {
      constexpr int kFirst = 10;
      const auto moved = [&](int k, double x_m) {
        const SE3 T = along_wall(k);
        return MovedPose{k / 30.0, T, SE3(Eigen::Matrix3d::Identity(), {x_m, 0, 0}) * T};
      };
      tracker->revise(
          {PoseCorrection({moved(0, 0.06), moved(kFirst, 0.06), moved(kFirst + 1, 0)})});
    }
    const TrackResult r = tracker->track(alignment::see_wall(along_wall(i), i), nullptr);
    EXPECT_NE(r.status, TrackingStatus::kLost) << i;
    EXPECT_LT(distance_m(r.T_odom_camera, along_wall(i)), 0.01) << i;
    if (i >= kDrifted) {
      EXPECT_LT(r.diagnostics.visual_cost, 0.5) << i;
    }
  }
}

TEST(SpectralTracker, NeverJumps) {
  const auto tracker = must_make({}, alignment::kWallCamera, alignment::wall_pose(0));
  for (int i = 0; i < 5; ++i)
    tracker->track(alignment::see_wall(alignment::wall_pose(i), i), nullptr);
  SE3 elsewhere = alignment::wall_pose(5);
  elsewhere.t.x() += 3;
  const auto r = tracker->track(alignment::see_wall(elsewhere, 5), nullptr);
  EXPECT_EQ(r.status, TrackingStatus::kLost);
  EXPECT_LT(distance_m(r.T_odom_camera, alignment::wall_pose(5)), 0.1);
}

TEST(SpectralTracker, WaitsForDepth) {
  const auto tracker = must_make({}, alignment::kWallCamera, alignment::wall_pose(0));
  RgbdFrame blind = alignment::see_wall(alignment::wall_pose(0), 0);
  blind.depth.fill(0);
  EXPECT_EQ(tracker->track(blind, nullptr).status, TrackingStatus::kLost);
  EXPECT_NE(tracker->track(alignment::see_wall(alignment::wall_pose(0), 1), nullptr).status,
            TrackingStatus::kLost);
  EXPECT_NE(tracker->track(alignment::see_wall(alignment::wall_pose(1), 2), nullptr).status,
            TrackingStatus::kLost);
}

// Neither a picture nor depth: nothing was observed, and nothing may be said to be.
TEST(SpectralTracker, ABlackFrameIsLost) {
  const auto tracker = must_make({}, alignment::kWallCamera, alignment::wall_pose(0));
  for (int i = 0; i < 5; ++i)
    tracker->track(alignment::see_wall(alignment::wall_pose(i), i), nullptr);
  RgbdFrame black = alignment::see_wall(alignment::wall_pose(5), 5);
  black.depth.fill(0);
  black.color.fill({});
  const TrackResult result = tracker->track(black, nullptr);
  EXPECT_EQ(result.status, TrackingStatus::kLost);
  EXPECT_EQ(result.lost_reason, alignment::LostReason::kNoDepth);
}

TEST(SpectralTracker, FollowsThePictureWhereDepthFails) {
  const auto tracker = must_make({}, alignment::kWallCamera, alignment::wall_pose(0));
  for (int i = 0; i < 10; ++i) {
    RgbdFrame frame = alignment::see_wall(alignment::wall_pose(i), i);
    if (i >= 5) frame.depth.fill(0);
    const TrackResult result = tracker->track(frame, nullptr);
    EXPECT_NE(result.status, TrackingStatus::kLost) << i;
    EXPECT_LT(distance_m(result.T_odom_camera, alignment::wall_pose(i)), 0.01) << i;
  }
}

// Carried along a wall whose surface is everywhere the same: only the picture tells.
TEST(SpectralTracker, SurfacesAreNotBelievedAgainstThePicture) {
  const auto tracker = must_make({}, alignment::kWallCamera, alignment::wall_pose(0));
  for (int i = 0; i < 10; ++i)
    tracker->track(alignment::see_wall(alignment::wall_pose(i), i), nullptr);
  SE3 elsewhere = alignment::wall_pose(10);
  elsewhere.t.x() += 50;
  int lost = 0;
  for (int i = 10; i < 40; ++i) {
    lost +=
        tracker->track(alignment::see_wall(elsewhere, i), nullptr).status == TrackingStatus::kLost;
  }
  EXPECT_EQ(lost, 30);
  const TrackResult back =
      tracker->track(alignment::see_wall(alignment::wall_pose(9), 40), nullptr);
  EXPECT_NE(back.status, TrackingStatus::kLost);
  EXPECT_LT(distance_m(back.T_odom_camera, alignment::wall_pose(9)), 0.01);
}

// What it tracks by are points and pixels of its own: the pictures lie on a disk that may be slow.
TEST(SpectralTracker, ReadsTheDiskOnlyOnceItIsLost) {
  const auto views =
      std::make_shared<history::ViewStore>(1, history::ViewStore::Options{.least_in_memory = 1});
  auto made = make_tracker({}, alignment::kWallCamera, alignment::wall_pose(0));
  ASSERT_TRUE(made);
  (*made)->remember_in(views);
  Odometry tracker(std::move(*made));
  for (int i = 0; i < 60; ++i) {
    EXPECT_NE(tracker.track(alignment::see_wall(alignment::wall_pose(i), i), nullptr).status,
              TrackingStatus::kLost)
        << i;
    views->settle();
  }
  EXPECT_EQ(views->reads(), 0u);
  SE3 elsewhere = alignment::wall_pose(10);
  elsewhere.t.x() += 50;
  for (int i = 61; i < 75; ++i) tracker.track(alignment::see_wall(elsewhere, i), nullptr);
  EXPECT_GT(views->reads(), 0u);
}

// From far off most of what was near can still be seen, too small to be aligned to: the frame in
// which the camera is found must be as well aligned as those that follow.
TEST(SpectralTracker, CarriedBackToTheWallItIsAlignedToWhatItSawThere) {
  const auto before_wall = [](double distance_m) {
    return SE3(so3_exp({0.03, -0.02, 0.01}), {0, 0, alignment::kWallDistance_m - distance_m});
  };
  constexpr int kAway = 60;  // frames
  const auto tracker = must_make({}, alignment::kWallCamera, before_wall(0.8));
  for (int i = 0; i < kAway; ++i) {
    const auto r = tracker->track(alignment::see_wall(before_wall(0.8 + 0.04 * i), i), nullptr);
    ASSERT_NE(r.status, TrackingStatus::kLost) << i;
  }
  const SE3 back = before_wall(0.82);
  const TrackResult found = tracker->track(alignment::see_wall(back, kAway), nullptr);
  EXPECT_NE(found.status, TrackingStatus::kLost);
  EXPECT_LT(distance_m(found.T_odom_camera, back), 0.005);
  const TrackResult next = tracker->track(alignment::see_wall(back, kAway + 1), nullptr);
  EXPECT_GT(found.diagnostics.visual_inliers, 0.9 * next.diagnostics.visual_inliers);
  EXPECT_LT(found.diagnostics.visual_cost, 1.05 * next.diagnostics.visual_cost);
}

TEST(SpectralTracker, SurvivesBrightnessChanges) {
  const auto tracker = must_make({}, alignment::kWallCamera, alignment::wall_pose(0));
  for (int i = 0; i < 20; ++i) {
    RgbdFrame frame = alignment::see_wall(alignment::wall_pose(i), i);
    const double gain = 1 + 0.2 * std::sin(0.8 * i);
    for (std::size_t k = 0; k < frame.color.size(); ++k) {
      Rgb8& c = frame.color.data()[k];
      c.r = c.g = c.b = static_cast<std::uint8_t>(std::min(255.0, gain * c.r));
    }
    const auto r = tracker->track(frame, nullptr);
    EXPECT_NE(r.status, TrackingStatus::kLost) << i;
    EXPECT_LT(distance_m(r.T_odom_camera, alignment::wall_pose(i)), 0.01) << i;
  }
}

alignment::KnownView view_of_wall(const SE3& T_world_camera, int index = 0) {
  alignment::KnownView view;
  const RgbdFrame frame = alignment::see_wall(T_world_camera, index);
  view.timestamp_s = 1000 + frame.timestamp_s;  // of another day
  view.T_world_camera = T_world_camera;
  view.frame = frame;
  view.fern_seed = 7;
  view.ferns = features::Ferns(view.fern_seed).code(frame);
  return view;
}

std::unique_ptr<Odometry> tracker_that_knows_the_wall() {
  auto tracker = must_make(TrackerConfig(), alignment::kWallCamera, SE3{});
  EXPECT_EQ(tracker->place_search(), nullptr);
  for (int i = 0; i < 40; i += 4) tracker->know(view_of_wall(alignment::wall_pose(i), i));
  return tracker;
}

TEST(SpectralTracker, FindsItselfInAMapThatItIsGivenAndGoesOnThere) {
  const auto tracker = tracker_that_knows_the_wall();
  ASSERT_NE(tracker->place_search(), nullptr);
  int lost = 0;
  for (int i = 18; i < 40; ++i) {
    const TrackResult r = tracker->track(alignment::see_wall(alignment::wall_pose(i), i), nullptr);
    if (r.status == TrackingStatus::kLost) {
      EXPECT_EQ(r.lost_reason, alignment::LostReason::kNotInMap);
      ++lost;
      continue;
    }
    EXPECT_LT(distance_m(r.T_odom_camera, alignment::wall_pose(i)), 0.01) << i;
  }
  EXPECT_GE(lost, 1) << "one frame alone is not believed";
  EXPECT_LE(lost, 5);
  EXPECT_TRUE(tracker->place_search()->found);
}

TEST(SpectralTracker, RatherStaysLostThanTakesAnotherPlaceForTheMaps) {
  const auto tracker = tracker_that_knows_the_wall();
  const SE3 elsewhere(Eigen::Matrix3d::Identity(), {7, 3, 0});  // papered otherwise
  for (int i = 0; i < 10; ++i) {
    const TrackResult r =
        tracker->track(alignment::see_wall(elsewhere * alignment::wall_pose(i), i), nullptr);
    EXPECT_EQ(r.lost_reason, alignment::LostReason::kNotInMap) << i;
  }
  const PlaceSearch& search = *tracker->place_search();
  EXPECT_FALSE(search.found);
  EXPECT_EQ(search.looks, 10);
  EXPECT_LT(search.best_inliers, search.needed_inliers);
}

// What a map of one view at two thirds of the distance shows fills less than half of the frame.
TEST(SpectralTracker, FindsItselfInAMapThatItSeesFromFartherAway) {
  const SE3 nearer(Eigen::Matrix3d::Identity(), {0.05, 0.03, alignment::kWallDistance_m / 3});
  for (const bool here : {true, false}) {
    const SE3 place = here ? SE3{} : SE3(Eigen::Matrix3d::Identity(), {7, 3, 0});
    const auto tracker = must_make(TrackerConfig(), alignment::kWallCamera, SE3{});
    tracker->know(view_of_wall(nearer));
    for (int i = 0; i < 10; ++i) {
      const TrackResult r =
          tracker->track(alignment::see_wall(place * alignment::wall_pose(i), i), nullptr);
      if (r.status == TrackingStatus::kLost) continue;
      EXPECT_LT(distance_m(r.T_odom_camera, alignment::wall_pose(i)), 0.01) << i;
    }
    EXPECT_EQ(tracker->place_search()->found, here);
  }
}

// How much later than its stamp the tracker takes depth for measured in the end, in a map whose
// calibration knows the delay to `sigma_s`; 0: there is no calibration.
constexpr double kLate_s = 0.008;
double delay_learned_in_a_map(double sigma_s) {
  const auto tracker = must_make(TrackerConfig(), alignment::kWallCamera, SE3{});
  if (sigma_s > 0) {
    DepthCalibration calibration;
    calibration.delay_sigma_s = sigma_s;
    tracker->revise({{}, std::make_shared<const DepthCalibration>(calibration)});
  }
  for (int i = 0; i < 40; i += 8) tracker->know(view_of_wall(swinging(i / 30.0)));
  double learned_s = 0;
  for (int i = 0; i < 40; ++i) {
    RgbdFrame frame = alignment::see_wall(swinging(i / 30.0), i);
    frame.depth = alignment::see_wall(swinging(i / 30.0 + kLate_s), i).depth;
    const TrackResult r = tracker->track(frame, nullptr);
    if (r.status != TrackingStatus::kLost) learned_s = r.motion.learned_delay_s;
  }
  return learned_s;
}

TEST(SpectralTracker, WhatTheCalibrationOfAMapKnowsIsNotLearnedThere) {
  EXPECT_NEAR(delay_learned_in_a_map(0), kLate_s, 5e-4);
  EXPECT_LT(std::abs(delay_learned_in_a_map(1e-5)), 0.33 * kLate_s);
}

}  // namespace
}  // namespace sgs::tracker
