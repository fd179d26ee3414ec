// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/tracker/paper_tracker.h"

#include <gtest/gtest.h>

#include <bit>

#include "sgs/alignment/test_textured_wall.h"
#include "sgs/tracker/test_tracker.h"

namespace sgs::tracker {
namespace {

constexpr int kWallFrames = 24;

struct PaperRun {
  std::vector<TrackResult> results;
  double end_error_m = 0;
};

PaperRun run_paper(const TrackerConfig& config, bool papered = true) {
  PaperRun run;
  const auto tracker = must_make(config, alignment::kWallCamera, alignment::wall_pose(0));
  for (int i = 0; i < kWallFrames; ++i) {
    run.results.push_back(
        tracker->track(alignment::see_wall(alignment::wall_pose(i), i, papered), nullptr));
  }
  run.end_error_m =
      (run.results.back().T_odom_camera.t - alignment::wall_pose(kWallFrames - 1).t).norm();
  return run;
}

TrackerConfig paper_config() {
  TrackerConfig config = paper_tracker_config();
  config.orb.features = 400;
  return config;
}

TEST(PaperTracker, FollowsATexturedWallAlongWhichRegistrationSlides) {
  TrackerConfig gicp = paper_config();
  gicp.type = TrackerType::kGicp;
  const double sliding = run_paper(gicp).end_error_m;
  // The camera moves 16 cm before the eyes of the prior (and 3 cm before they open).
  EXPECT_GT(sliding, 0.10);
  const PaperRun run = run_paper(paper_config());
  EXPECT_LT(run.end_error_m, 0.05);
  const Diagnostics& d = run.results.back().diagnostics;
  EXPECT_EQ(run.results.back().status, TrackingStatus::kDegenerate);
  EXPECT_EQ(d.prior_source, PriorSource::kOrb);
  EXPECT_TRUE(d.prior_active);
  EXPECT_EQ(d.planarity, 1);
  EXPECT_GT(d.condition_number, 200);
  EXPECT_GE(std::popcount(d.degenerate_mask), 2);
  EXPECT_EQ(d.weights[0], 1);  // all of Omega
}

TEST(PaperTracker, HasNoPriorBeforeItsFirstFrame) {
  TrackerConfig config = paper_config();
  config.prior.first_frame = 7;
  const PaperRun run = run_paper(config);
  for (int i = 0; i < kWallFrames; ++i) {
    const Diagnostics& d = run.results[static_cast<std::size_t>(i)].diagnostics;
    EXPECT_EQ(d.prior_active, i >= 7) << i;
    EXPECT_EQ(d.prior_source, i >= 7 ? PriorSource::kOrb : PriorSource::kNone) << i;
  }
}

TEST(PaperTracker, RejectedPriorStandsForNoMotion) {
  TrackerConfig config = paper_config();
  config.prior.first_frame = 1;
  const PaperRun run = run_paper(config, false);
  EXPECT_EQ(run.results.back().diagnostics.prior_source, PriorSource::kZero);
  // Along the wall the pose is locked; off it the wall itself is still seen.
  EXPECT_NEAR(run.results.back().T_odom_camera.t.x(), 0, 0.02);
  EXPECT_NEAR(run.results.back().T_odom_camera.t.z(), alignment::wall_pose(kWallFrames - 1).t.z(),
              0.01);
}

TEST(PaperTracker, PlanarityAloneCallsForThePrior) {
  TrackerConfig config = paper_config();
  config.degeneracy.condition_threshold = 1e12;
  const PaperRun run = run_paper(config);
  const TrackResult& last = run.results.back();
  EXPECT_TRUE(last.diagnostics.prior_active);
  EXPECT_EQ(last.diagnostics.degenerate_mask, 0u);
  EXPECT_EQ(last.status, TrackingStatus::kDegenerate);
}

TEST(PaperTracker, PlanarityAloneDoesNotHoldThePoseForWantOfAPrior) {
  TrackerConfig config = paper_config();
  config.degeneracy.condition_threshold = 1e12;
  const TrackResult last = run_paper(config, false).results.back();
  EXPECT_EQ(last.diagnostics.prior_source, PriorSource::kZero);
  EXPECT_FALSE(last.diagnostics.prior_active);
}

TEST(PaperTracker, AnUnreachableThresholdSwitchesThePriorOff) {
  TrackerConfig config = paper_config(), gicp = config;
  config.degeneracy.condition_threshold = 1e12;
  config.degeneracy.planarity_alone = false;
  gicp.type = TrackerType::kGicp;
  const PaperRun a = run_paper(config), b = run_paper(gicp);
  for (std::size_t i = 0; i < a.results.size(); ++i) {
    EXPECT_FALSE(a.results[i].diagnostics.prior_active);
    EXPECT_EQ(a.results[i].T_odom_camera.t, b.results[i].T_odom_camera.t);
  }
}

TEST(PaperTracker, AblationsChangeWhatTheySay) {
  TrackerConfig no_planarity = paper_config();
  no_planarity.prior.planarity = false;
  const Diagnostics axes = run_paper(no_planarity).results.back().diagnostics;
  for (unsigned k = 0; k < 6; ++k) {
    EXPECT_EQ(axes.weights[k], ((axes.degenerate_mask >> k) & 1u) != 0 ? 1.0 : 0.0);
  }
  EXPECT_GT(std::popcount(axes.degenerate_mask), 0);
  EXPECT_LT(std::popcount(axes.degenerate_mask), 6);

  TrackerConfig only = paper_config();
  only.prior.only = true;
  const PaperRun prior_only = run_paper(only);
  EXPECT_LT(prior_only.end_error_m, 0.05);
  EXPECT_EQ(prior_only.results.back().diagnostics.iterations, 0);

  TrackerConfig constant = paper_config();
  constant.prior.source = PosePriorSource::kConstantVelocity;
  const PaperRun cvm = run_paper(constant);
  EXPECT_EQ(cvm.results.back().diagnostics.prior_source, PriorSource::kConstantVelocity);
  EXPECT_EQ(cvm.results.back().diagnostics.visual_inliers, 0);
}

TEST(PaperTracker, HoldsThePoseWithoutDepth) {
  const auto tracker = must_make(paper_config(), alignment::kWallCamera, alignment::wall_pose(0));
  SE3 last;
  for (int i = 0; i < 6; ++i)
    last = tracker->track(alignment::see_wall(alignment::wall_pose(i), i), nullptr).T_odom_camera;
  RgbdFrame dark = alignment::see_wall(alignment::wall_pose(6), 6);
  dark.depth.fill(0);
  const TrackResult held = tracker->track(dark, nullptr);
  EXPECT_EQ(held.status, TrackingStatus::kLost);
  EXPECT_FALSE(held.keyframe);
  EXPECT_EQ(held.T_odom_camera.t, last.t);
  EXPECT_NE(tracker->track(alignment::see_wall(alignment::wall_pose(7), 7), nullptr).status,
            TrackingStatus::kLost);
}

TEST(PaperTracker, SameInputGivesTheSameBits) {
  const PaperRun a = run_paper(paper_config()), b = run_paper(paper_config());
  for (std::size_t i = 0; i < a.results.size(); ++i) {
    EXPECT_EQ(a.results[i].T_odom_camera.t, b.results[i].T_odom_camera.t);
    EXPECT_EQ(a.results[i].T_odom_camera.R, b.results[i].T_odom_camera.R);
  }
}

}  // namespace
}  // namespace sgs::tracker
