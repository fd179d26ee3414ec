// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "sgs/alignment/targets/target_map.h"
#include "sgs/registration/cloud_sampler.h"
#include "sgs/tracker/motion_model.h"
#include "sgs/tracker/test_tracker.h"
#include "sgs/tracker/tracker.h"
#include "sgs/tracker/tracker_config.h"

namespace sgs::tracker {
namespace {

const PinholeCamera kCamera{320, 240, 270, 268, 159.3, 121.1};

struct Plane {
  Eigen::Vector3d normal;  // of n.p = d, towards the free side
  double d;
};

// A room of 4 x 3 x 4 m around the origin with a box standing in it.
std::vector<Plane> room() {
  return {{{-1, 0, 0}, -2},  {{1, 0, 0}, -2},  {{0, -1, 0}, -1.2},
          {{0, 1, 0}, -1.8}, {{0, 0, -1}, -2}, {{0, 0, 1}, -2}};
}

bool hit_box(const Eigen::Vector3d& from, const Eigen::Vector3d& ray, double& distance) {
  const Eigen::Vector3d low(0.7, 0.75, 0.8), high(1.1, 1.2, 1.3);
  double enter = 0, leave = 1e9;
  for (int k = 0; k < 3; ++k) {
    const double a = (low[k] - from[k]) / ray[k], b = (high[k] - from[k]) / ray[k];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  if (!(enter < leave && enter > 0)) return false;
  distance = enter;
  return true;
}

// Depth image of planes (and the box, if asked for) from a pose, quantised like a 16-bit file.
RgbdFrame render(const std::vector<Plane>& planes, bool box, const SE3& T_world_camera, int index) {
  RgbdFrame frame;
  frame.index = index;
  frame.timestamp_s = index / 30.0;
  frame.camera = kCamera;
  frame.color = ColorImage(kCamera.width, kCamera.height);
  frame.depth = DepthImage(kCamera.width, kCamera.height);
  for (int v = 0; v < kCamera.height; ++v) {
    for (int u = 0; u < kCamera.width; ++u) {
      const Eigen::Vector3d ray = T_world_camera.R * kCamera.back_project(u, v, 1.0);
      double z = 1e9, distance = 0;
      for (const Plane& p : planes) {
        const double hit = (p.d - p.normal.dot(T_world_camera.t)) / p.normal.dot(ray);
        if (hit > 0) z = std::min(z, hit);
      }
      if (box && hit_box(T_world_camera.t, ray, distance)) z = std::min(z, distance);
      frame.depth(u, v) = z < 10 ? static_cast<float>(std::round(z * 5000) / 5000) : 0.0f;
    }
  }
  return frame;
}

// Hand-held-like path before a corner of the room: about 1 cm and half a degree per frame.
SE3 pose_at(double index) {
  const double s = index / 30.0;
  const SE3 into_the_corner(so3_exp({0, 0.78, 0}) * so3_exp({-0.45, 0, 0}), {0, 0, 0});
  const SE3 motion(
      so3_exp({0.12 * std::sin(0.9 * s), 0.45 * std::sin(0.5 * s), 0.08 * std::sin(1.3 * s)}),
      {0.35 * std::sin(0.8 * s), 0.12 * std::sin(1.1 * s), 0.25 * std::sin(0.6 * s)});
  return into_the_corner * motion;
}

struct RoomRun {
  std::vector<TrackResult> results;
  double worst_m = 0;
  int lost = 0, keyframes = 0;
};

RoomRun run_room(const TrackerConfig& config, int frames, const SE3& T_world_room = {}) {
  RoomRun run;
  const auto tracker = must_make(config, kCamera, T_world_room * pose_at(0));
  for (int i = 0; i < frames; ++i) {
    run.results.push_back(tracker->track(render(room(), true, pose_at(i), i), nullptr));
    const TrackResult& r = run.results.back();
    run.worst_m = std::max(run.worst_m, (r.T_odom_camera.t - (T_world_room * pose_at(i)).t).norm());
    run.lost += r.status == TrackingStatus::kLost;
    run.keyframes += r.keyframe;
  }
  return run;
}

TrackerConfig gicp_config() {
  TrackerConfig config;
  config.type = TrackerType::kGicp;
  return config;
}

TrackerConfig paper_on_own_points() {
  TrackerConfig config = paper_tracker_config();
  config.type = TrackerType::kGicp;
  config.points.max_depth_m = 5;
  return config;
}

TEST(GicpTracker, DefaultPresetStaysWithinFiveMillimetresInARoom) {
  const RoomRun run = run_room(gicp_config(), 60);
  EXPECT_LT(run.worst_m, 0.005);
  EXPECT_EQ(run.lost, 0);
  EXPECT_TRUE(run.results[0].keyframe);
  EXPECT_LT(run.keyframes, 20);
  const Diagnostics& d = run.results.back().diagnostics;
  EXPECT_GT(d.source_points, 700);
  EXPECT_GT(d.inliers, d.source_points / 2);
  EXPECT_GT(d.overlap, 0.5);
  EXPECT_GE(d.iterations, 1);
  EXPECT_GT(d.condition_number, 1);
  EXPECT_EQ(run.results.back().status, TrackingStatus::kOk);
}

TEST(GicpTracker, PaperPresetStaysWithinFiveMillimetresInARoom) {
  const RoomRun run = run_room(paper_on_own_points(), 40);
  EXPECT_LT(run.worst_m, 0.005);
  EXPECT_EQ(run.lost, 0);
}

TEST(GicpTracker, MovingTheWorldByAHundredMetresChangesNoDecision) {
  const SE3 T_world_room(so3_exp({0.4, 1.1, -0.3}), {100, -70, 40});
  const RoomRun here = run_room(gicp_config(), 25),
                there = run_room(gicp_config(), 25, T_world_room);
  for (std::size_t i = 0; i < here.results.size(); ++i) {
    const TrackResult &a = here.results[i], &b = there.results[i];
    EXPECT_EQ(a.status, b.status);
    EXPECT_EQ(a.keyframe, b.keyframe);
    EXPECT_EQ(a.diagnostics.inliers, b.diagnostics.inliers);
    EXPECT_EQ(a.diagnostics.iterations, b.diagnostics.iterations);
    EXPECT_LT((T_world_room * a.T_odom_camera.t - b.T_odom_camera.t).norm(), 1e-9);
  }
}

TEST(GicpTracker, SameInputGivesTheSameBits) {
  for (const TrackerConfig& config : {gicp_config(), paper_on_own_points()}) {
    const RoomRun a = run_room(config, 12), b = run_room(config, 12);
    for (std::size_t i = 0; i < a.results.size(); ++i) {
      EXPECT_EQ(a.results[i].T_odom_camera.R, b.results[i].T_odom_camera.R);
      EXPECT_EQ(a.results[i].T_odom_camera.t, b.results[i].T_odom_camera.t);
    }
  }
}

TEST(GicpTracker, HoldsThePoseWithoutDepthAndRecoversWhenItReturns) {
  const auto tracker = must_make(gicp_config(), kCamera, pose_at(0));
  TrackResult last;
  for (int i = 0; i < 10; ++i) last = tracker->track(render(room(), true, pose_at(i), i), nullptr);
  ASSERT_NE(last.status, TrackingStatus::kLost);
  for (int i = 10; i < 15; ++i) {
    RgbdFrame dark = render(room(), true, pose_at(i), i);
    dark.depth.fill(0);
    const TrackResult held = tracker->track(dark, nullptr);
    EXPECT_EQ(held.status, TrackingStatus::kLost);
    EXPECT_FALSE(held.keyframe);
    EXPECT_EQ(held.diagnostics.source_points, 0);
    EXPECT_EQ(held.T_odom_camera.t, last.T_odom_camera.t);
  }
  for (int i = 15; i < 20; ++i) {
    const TrackResult r = tracker->track(render(room(), true, pose_at(i), i), nullptr);
    EXPECT_NE(r.status, TrackingStatus::kLost) << i;
    EXPECT_LT((r.T_odom_camera.t - pose_at(i).t).norm(), 0.005) << i;
  }
}

TEST(GicpTracker, StartsWithTheFirstFrameThatHasDepth) {
  const auto tracker = must_make(gicp_config(), kCamera, pose_at(3));
  RgbdFrame dark = render(room(), true, pose_at(0), 0);
  dark.depth.fill(0);
  EXPECT_EQ(tracker->track(dark, nullptr).status, TrackingStatus::kLost);
  const TrackResult r = tracker->track(render(room(), true, pose_at(3), 3), nullptr);
  EXPECT_TRUE(r.keyframe);
  EXPECT_EQ(r.status, TrackingStatus::kOk);
  EXPECT_EQ(r.T_odom_camera.t, pose_at(3).t);
}

TEST(GicpTracker, RefusesAFrameFromElsewhere) {
  const auto tracker = must_make(gicp_config(), kCamera, pose_at(0));
  SE3 last;
  for (int i = 0; i < 6; ++i) {
    last = tracker->track(render(room(), true, pose_at(i), i), nullptr).T_odom_camera;
  }
  const SE3 elsewhere = pose_at(5) * SE3(so3_exp({0, 1.2, 0}), {0.5, 0, 0});
  const TrackResult r = tracker->track(render(room(), true, elsewhere, 6), nullptr);
  EXPECT_EQ(r.status, TrackingStatus::kLost);
  EXPECT_EQ(r.T_odom_camera.t, last.t);
  const TrackResult back = tracker->track(render(room(), true, pose_at(7), 7), nullptr);
  EXPECT_NE(back.status, TrackingStatus::kLost);
  EXPECT_LT((back.T_odom_camera.t - pose_at(7).t).norm(), 0.005);
}

TEST(GicpTracker, ReportsAPlaneAsDegenerate) {
  const auto tracker = must_make(gicp_config(), kCamera, SE3{});
  const std::vector<Plane> wall = {{{0, 0, -1}, -1.5}};
  tracker->track(render(wall, false, SE3{}, 0), nullptr);
  for (int i = 1; i < 4; ++i) {
    const SE3 T(Eigen::Matrix3d::Identity(), {0.01 * i, 0, 0});
    const TrackResult r = tracker->track(render(wall, false, T, i), nullptr);
    EXPECT_EQ(r.status, TrackingStatus::kDegenerate);
    EXPECT_EQ(std::popcount(r.diagnostics.degenerate_mask), 3);  // two shifts and a turn
    EXPECT_TRUE(r.T_odom_camera.all_finite());
  }
}

TEST(GicpTracker, IgnoresGroundTruth) {
  const auto a = must_make(gicp_config(), kCamera, pose_at(0)),
             b = must_make(gicp_config(), kCamera, pose_at(0));
  for (int i = 0; i < 4; ++i) {
    RgbdFrame frame = render(room(), true, pose_at(i), i);
    const TrackResult plain = a->track(frame, nullptr);
    frame.truth_T_world_camera = SE3(so3_exp({1, 2, 3}), {4, 5, 6});
    EXPECT_EQ(b->track(frame, nullptr).T_odom_camera.t, plain.T_odom_camera.t);
  }
}

// Gaussians as a mapper would make them from a frame: one per n-th pixel, flat along the surface.
std::shared_ptr<map::Snapshot> snapshot_of(const SE3& T, const SE3& T_world_room, int step) {
  auto snapshot = std::make_shared<map::Snapshot>();
  const RgbdFrame frame = render(room(), true, T, 0);
  const auto sampler = registration::make_sampler({.step_px = step}, kCamera, false);
  registration::SourceCloud cloud;
  sampler->sample(frame.depth, cloud);
  const SE3 T_world_camera = T_world_room * T;
  for (const auto& p : cloud.points) {
    map::Anchor anchor;
    anchor.point = (T_world_camera * p.point.cast<double>().eval()).cast<float>();
    anchor.normal = T_world_camera.R.cast<float>() * p.normal;
    anchor.sigma_n_m = std::sqrt(p.variance_m2);
    anchor.keyframe = 0;
    map::Gaussian g{};
    const Eigen::Quaternionf q =
        Eigen::Quaternionf::FromTwoVectors(Eigen::Vector3f::UnitZ(), -anchor.normal);
    for (int k = 0; k < 3; ++k) g.mean[k] = anchor.point[k];
    g.log_scale[0] = g.log_scale[1] = std::log(0.01f);
    g.log_scale[2] = std::log(0.001f);
    g.rotation[0] = q.w();
    g.rotation[1] = q.x();
    g.rotation[2] = q.y();
    g.rotation[3] = q.z();
    g.opacity_logit = 2;
    snapshot->anchors.push_back(anchor);
    snapshot->gaussians.push_back(g);
  }
  snapshot->version = 1;
  return snapshot;
}

class SnapshotTargetsTest
    : public testing::TestWithParam<std::tuple<alignment::TargetSource, bool>> {
 protected:
  TrackerConfig config() const {
    TrackerConfig c = std::get<1>(GetParam()) ? paper_on_own_points() : gicp_config();
    c.target.source = std::get<0>(GetParam());
    return c;
  }
};

TEST_P(SnapshotTargetsTest, TracksAgainstTheGaussiansOfASnapshot) {
  const SE3 T_world_room(so3_exp({0.3, -0.2, 0.5}), {3, 1, -2});
  const auto tracker = must_make(config(), kCamera, T_world_room * pose_at(0));
  EXPECT_TRUE(tracker->follows_map());
  const auto snapshot = snapshot_of(pose_at(0), T_world_room, 4);
  for (int i = 0; i < 12; ++i) {
    // The first frames come before any map exists.
    const map::SnapshotPtr seen = i < 3 ? nullptr : snapshot;
    const TrackResult r = tracker->track(render(room(), true, pose_at(i), i), seen);
    EXPECT_NE(r.status, TrackingStatus::kLost);
    EXPECT_LT((r.T_odom_camera.t - (T_world_room * pose_at(i)).t).norm(), 0.005) << i;
  }
}

TEST_P(SnapshotTargetsTest, SurvivorsKeepTheirIndexAndPrunedOnesDie) {
  const auto targets =
      alignment::make_target_map(aligner_config(config()).geometry, SE3{}, kCamera.fx);
  auto first = snapshot_of(pose_at(0), SE3{}, 16);
  const std::size_t n = first->anchors.size();
  targets->update(alignment::LocalPast(), first);
  ASSERT_EQ(targets->cloud().points.size(), n);
  const std::uint64_t layout = targets->cloud().layout;

  auto second = std::make_shared<map::Snapshot>(*first);
  second->version = 2;
  second->anchors.erase(second->anchors.begin() + 7);
  second->gaussians.erase(second->gaussians.begin() + 7);
  second->gaussians[20].opacity_logit = -5;  // too transparent
  map::Anchor added = second->anchors[0];
  added.point.x() += 0.5f;
  added.keyframe = 1;
  second->anchors.push_back(added);
  second->gaussians.push_back(second->gaussians[0]);
  targets->update(alignment::LocalPast(), second);
  const registration::TargetCloud& cloud = targets->cloud();
  EXPECT_EQ(cloud.layout, layout);
  ASSERT_EQ(cloud.points.size(), n + 1);
  EXPECT_FALSE(cloud.points[7].alive());
  EXPECT_FALSE(cloud.points[21].alive());
  EXPECT_TRUE(cloud.points[8].alive());
  EXPECT_LT((cloud.points[8].point - second->anchors[7].point).norm(), 1e-6f);

  // Another order is a new map.
  auto third = std::make_shared<map::Snapshot>(*second);
  third->version = 3;
  std::reverse(third->anchors.begin(), third->anchors.end());
  std::reverse(third->gaussians.begin(), third->gaussians.end());
  targets->update(alignment::LocalPast(), third);
  EXPECT_NE(targets->cloud().layout, layout);
  EXPECT_EQ(targets->cloud().points.size(), n);
}

INSTANTIATE_TEST_SUITE_P(Sources, SnapshotTargetsTest,
                         testing::Combine(testing::Values(alignment::TargetSource::kAnchor,
                                                          alignment::TargetSource::kOptimised),
                                          testing::Bool()));

/// Points and where their keyframes are.
struct Points : alignment::TrackablePoints {
  using alignment::TrackablePoints::TrackablePoints;
  int see(const registration::SourceCloud& source, const SE3& T,
          const registration::CorrespondenceSearch* search = nullptr,
          const registration::FrameMotion& motion = {}) {
    const auto frame = static_cast<std::int64_t>(now.path.size());
    const int added = insert(source, {frame, T, motion}, search);
    now.path.append({frame, 0.1 * static_cast<double>(frame), T});
    follow();
    return added;
  }
  /// With this many metres more for the last keyframe; the others stay.
  void move_last(double x_m) {
    const history::Path::Entry last = now.path.back();
    const SE3 shift(Eigen::Matrix3d::Identity(), {x_m, 0, 0});
    std::vector<MovedPose> moved;
    if (now.path.size() > 1) {
      const history::Path::Entry before = now.path[now.path.size() - 2];
      moved.push_back({before.timestamp_s, before.T_odom_camera, before.T_odom_camera});
    }
    moved.push_back({last.timestamp_s, last.T_odom_camera, shift * last.T_odom_camera});
    now = history::revised(now, {PoseCorrection(moved)});
    follow();
  }
  /// Depth is by so much later than its stamps; the camera was where it was.
  void calibrate(double delay_s) {
    DepthCalibration calibration;
    calibration.camera = kCamera;
    calibration.delay_s = delay_s;
    const history::Path::Entry last = now.path.back();
    const MovedPose same{last.timestamp_s, last.T_odom_camera, last.T_odom_camera};
    now = history::revised(
        now, {PoseCorrection({same}), std::make_shared<const DepthCalibration>(calibration)});
    follow();
  }
  void follow() {
    alignment::LocalPast past;
    past.set_revision(now);
    alignment::TrackablePoints::follow(past);
  }
  history::Revision now;
};

TEST(TrackablePoints, AddsOnlyWhereNothingIsAndFollowsKeyframes) {
  registration::SourceCloud source;
  registration::make_sampler({}, kCamera, false)
      ->sample(render(room(), true, pose_at(0), 0).depth, source);
  Points points({0.03f, 0.03f});
  const int all = points.see(source, pose_at(0));
  EXPECT_EQ(all, static_cast<int>(source.points.size()));
  const auto search = registration::make_search({}, kCamera);
  search->prepare(points.cloud(), pose_at(0));
  EXPECT_EQ(points.see(source, pose_at(0), search.get()), 0);

  const registration::TargetPoint before = points.cloud().points[5];
  points.move_last(0.1);
  EXPECT_EQ(points.cloud().points[5].point, before.point) << "of the first keyframe, which stays";
  Points alone({0.03f, 0.03f});
  alone.see(source, pose_at(0));
  alone.move_last(0.1);
  EXPECT_LT((alone.cloud().points[5].point - before.point - Eigen::Vector3f(0.1f, 0, 0)).norm(),
            1e-5f);
}

// Points lie where the delay that was learned by then says. A calibration knows it better: it takes
// the place of what was learned, and comes on top of the stamps alone.
TEST(TrackablePoints, ACalibratedDelayTakesThePlaceOfTheLearnedOne) {
  constexpr double kStamped_s = -0.01, kLearned_s = -0.016, kSpeed_m_s = 0.5;
  registration::SourceCloud source;
  registration::make_sampler({}, kCamera, false)
      ->sample(render(room(), true, pose_at(0), 0).depth, source);
  registration::FrameMotion motion;
  motion.velocity(3) = kSpeed_m_s;
  motion.depth_delay_s = kStamped_s + kLearned_s;
  motion.learned_delay_s = kLearned_s;
  for (const double calibrated_s : {kLearned_s, kLearned_s - 0.004}) {
    Points points({0.03f, 0.03f});
    points.see(source, SE3{}, nullptr, motion);
    const Eigen::Vector3f before = points.cloud().points[5].point;
    points.calibrate(calibrated_s);
    const Eigen::Vector3f moved = points.cloud().points[5].point - before;
    const auto expected = static_cast<float>((calibrated_s - kLearned_s) * kSpeed_m_s);
    EXPECT_LT((moved - Eigen::Vector3f(expected, 0, 0)).norm(), 1e-5f) << calibrated_s;
    // What another calibration says more, comes on top of this one.
    points.calibrate(calibrated_s + 0.002);
    const Eigen::Vector3f further = points.cloud().points[5].point - before - moved;
    EXPECT_LT((further - Eigen::Vector3f(0.002f * static_cast<float>(kSpeed_m_s), 0, 0)).norm(),
              1e-5f);
  }
}

// A wall that was seen a long way ago and now lies before the one that is measured hides it:
// nothing behind it is found, and every frame would add it anew.
TEST(TrackablePoints, WhatAFrameLooksThroughGoesIfItIsOld) {
  const registration::SamplingConfig sampling;
  registration::SourceCloud source;
  registration::make_sampler(sampling, kCamera, false)
      ->sample(render(room(), true, pose_at(0), 0).depth, source);
  const registration::FreeSpace space(source, kCamera, sampling.step_px);
  registration::SourceCloud nearer = source;
  for (registration::SourcePoint& p : nearer.points) p.point *= 0.85f;
  const SE3 far_away(Eigen::Matrix3d::Identity(), {6, 0, 0});

  Points points({0.03f, 0.03f});
  const int old = points.see(nearer, pose_at(0));
  EXPECT_EQ(points.remove_in(space, pose_at(0)), 0);  // what was just seen holds the pose
  EXPECT_TRUE(points.cloud().removed.empty());
  points.see({}, far_away * pose_at(0));
  const int fresh = points.see(source, pose_at(0));
  const int removed = points.remove_in(space, pose_at(0));
  EXPECT_GT(removed, old / 2);  // the others lie beside edges
  EXPECT_EQ(points.cloud().removed.size(), static_cast<std::size_t>(removed));
  const auto& all = points.cloud().points;
  EXPECT_TRUE(std::all_of(all.end() - fresh, all.end(), [](const auto& p) { return p.alive(); }));
  EXPECT_EQ(points.remove_in(space, pose_at(0)), 0);
}

TEST(TrackablePoints, WhatHasMovedAwayGoesThoughItIsNew) {
  const registration::SamplingConfig sampling;
  registration::SourceCloud source;
  registration::make_sampler(sampling, kCamera, false)
      ->sample(render(room(), true, pose_at(0), 0).depth, source);
  const registration::FreeSpace space(source, kCamera, sampling.step_px);
  registration::SourceCloud near = source, nearly = source;
  for (registration::SourcePoint& p : near.points) p.point *= 0.7f;
  for (registration::SourcePoint& p : nearly.points) p.point *= 0.97f;

  Points points({0.03f, 0.03f});
  const int gone = points.see(near, pose_at(0));
  EXPECT_GT(points.remove_in(space, pose_at(0), 0.2f), gone / 2);
  Points others({0.03f, 0.03f});
  others.see(nearly, pose_at(0));
  EXPECT_EQ(others.remove_in(space, pose_at(0), 0.2f), 0);
}

TEST(TrackablePoints, EndSomewhere) {
  registration::SourceCloud source;
  registration::make_sampler({}, kCamera, false)
      ->sample(render(room(), true, pose_at(0), 0).depth, source);
  const std::size_t n = source.points.size();
  Points points({0.03f, 0.03f}, 10 * n);
  const auto at = [](double x) { return SE3(Eigen::Matrix3d::Identity(), {x, 0, 0}) * pose_at(0); };
  for (int k = 0; k < 40; ++k) {
    points.see(source, at(k));
    EXPECT_LE(points.alive(), 10 * n);
    EXPECT_LE(points.cloud().points.size(), 21 * n);
  }
  // What is left lies around the camera, and follows it still.
  const auto& cloud = points.cloud();
  const auto farthest = [&] {
    double x = 100;
    for (const auto& p : cloud.points) {
      if (p.alive()) x = std::min(x, static_cast<double>(p.point.x()));
    }
    return x;
  };
  EXPECT_GT(farthest(), 25);
  EXPECT_GT(cloud.layout, 0u);
  points.move_last(100);
  EXPECT_EQ(std::count_if(cloud.points.begin(), cloud.points.end(),
                          [](const auto& p) { return p.alive() && p.point.x() > 100; }),
            static_cast<std::ptrdiff_t>(n));
}

TEST(MotionModel, RepeatsTheDecayedMotionScaledWithTime) {
  MotionModel motion(MotionConfig{}, SE3{});
  Vector6d xi;
  xi << 0.01, 0, 0.02, 0.03, -0.01, 0;
  motion.accept(SE3{}, 0.0);
  EXPECT_EQ(motion.predict(0.1).t.norm(), 0);
  motion.accept(SE3::exp(xi), 0.1);
  const SE3 expected = SE3::exp(xi) * SE3::exp(0.95 * xi);
  EXPECT_LT((motion.predict(0.2).t - expected.t).norm(), 1e-12);
  const SE3 dropped_one = SE3::exp(xi) * SE3::exp(2 * 0.95 * xi);
  EXPECT_LT((motion.predict(0.3).t - dropped_one.t).norm(), 1e-12);
  motion.hold();
  EXPECT_EQ(motion.predict(0.3).t, SE3::exp(xi).t);
  EXPECT_EQ(motion.frames_held(), 1);
}

TEST(MotionModel, RefusesImpossibleMotions) {
  MotionModel motion(MotionConfig{}, SE3{});
  const auto shifted = [](double x) { return SE3(Eigen::Matrix3d::Identity(), {x, 0, 0}); };
  EXPECT_EQ(motion.judge(shifted(0.2)), alignment::LostReason::kNone);
  EXPECT_EQ(motion.judge(shifted(0.3)), alignment::LostReason::kImplausibleMotion);
  EXPECT_EQ(motion.judge(SE3(so3_exp({0, 0.6, 0}), {0, 0, 0})),
            alignment::LostReason::kImplausibleMotion);
  EXPECT_EQ(motion.judge(shifted(std::nan(""))), alignment::LostReason::kNotFinite);
  motion.hold();  // twice the time, twice the way
  EXPECT_EQ(motion.judge(shifted(0.3)), alignment::LostReason::kNone);
  for (int i = 0; i < 100; ++i) motion.hold();
  EXPECT_EQ(motion.judge(shifted(1.1)), alignment::LostReason::kImplausibleMotion);
}

TEST(MakeTracker, ConstantVelocityNeverLooks) {
  TrackerConfig config;
  config.type = TrackerType::kCvm;
  const auto tracker = must_make(config, kCamera, pose_at(0));
  for (int i = 0; i < 3; ++i) {
    const TrackResult r = tracker->track(render(room(), true, pose_at(i), i), nullptr);
    EXPECT_EQ(r.T_odom_camera.t, pose_at(0).t);
    EXPECT_EQ(r.diagnostics.prior_source, PriorSource::kConstantVelocity);
  }
}

TEST(MotionModel, GoesOnWithTheLastVelocityOnlyWhereItIsMeantTo) {
  const auto shifted = [](double x) { return SE3(Eigen::Matrix3d::Identity(), {x, 0, 0}); };
  MotionModel motion(MotionConfig{}, SE3{});
  motion.accept(SE3{}, 0.0);
  motion.accept(shifted(0.1), 0.1);
  motion.miss();
  EXPECT_NEAR(motion.predict(0.2).t.x(), 0.195, 1e-12);
  EXPECT_EQ(motion.frames_held(), 1);
  motion.jump_to(shifted(5));
  EXPECT_EQ(motion.predict(0.3).t.x(), 5);
  EXPECT_EQ(motion.judge(shifted(5.4)), alignment::LostReason::kNone);  // still two frames' worth
  motion.accept(shifted(5.4), 0.3);
  EXPECT_EQ(motion.frames_held(), 0);
  EXPECT_EQ(motion.predict(0.4).t.x(), 5.4);  // a jump is no velocity
}

TEST(MakeTracker, NamesWhatIsWrong) {
  TrackerConfig config;
  config.loss.min_points = 2;
  const auto refused = make_tracker(config, kCamera, SE3{});
  ASSERT_FALSE(refused.has_value());
  EXPECT_THAT(refused.error().message, testing::HasSubstr("loss.min_points"));
  EXPECT_FALSE(make_tracker(TrackerConfig{}, PinholeCamera{}, SE3{}).has_value());
}

TEST(TrackerConfig, FormerPriorFusionIsRefusedWithTheNewName) {
  TrackerConfig config;
  ParameterList list;
  config.declare(list);
  const auto refused = list.set("fusion", "prior");
  ASSERT_FALSE(refused.has_value());
  EXPECT_THAT(refused.error().remedy, testing::HasSubstr("tracker.type = \"paper\""));
}

TEST(TrackerConfig, EveryKeyIsDeclaredOnceAndPresetsAreInRange) {
  for (TrackerConfig config : {TrackerConfig{}, paper_tracker_config()}) {
    ParameterList list;
    config.declare(list);
    EXPECT_GT(list.parameters().size(), 30u);
    for (const Parameter& p : list.parameters()) {
      EXPECT_TRUE(p.set_from_text(p.value_text()).has_value()) << p.key;
      EXPECT_FALSE(p.doc.empty()) << p.key;
    }
  }
}

/// The same path from rest, so that the first frame is right in any case.
SE3 pose_from_rest(double index) {
  constexpr double kStart = 5, kRamp = 10;
  const double moving = std::max(0.0, index - kStart);
  return pose_at(moving < kRamp ? moving * moving / (2 * kRamp) : moving - kRamp / 2);
}

/// Largest error of position where depth is taken later than its colour, and the frame says so or
/// not.
double drift_with_lag(double delay_s, double told_s) {
  const auto tracker = must_make(gicp_config(), kCamera, pose_from_rest(0));
  double worst_m = 0;
  for (int i = 0; i < 60; ++i) {
    RgbdFrame frame = render(room(), true, pose_from_rest(i + 30 * delay_s), i);
    frame.depth_delay_s = told_s;
    const TrackResult r = tracker->track(frame, nullptr);
    EXPECT_NE(r.status, TrackingStatus::kLost) << i;
    worst_m = std::max(worst_m, (r.T_odom_camera.t - pose_from_rest(i).t).norm());
  }
  return worst_m;
}

TEST(GicpTracker, PosesAreThoseOfTheColourWhereDepthLags) {
  for (const double delay_s : {0.03, -0.03}) {
    const double unknown_m = drift_with_lag(delay_s, 0);
    const double known_m = drift_with_lag(delay_s, delay_s);
    EXPECT_GT(unknown_m, 0.006);
    EXPECT_LT(known_m, 0.5 * unknown_m);
  }
}

}  // namespace
}  // namespace sgs::tracker
