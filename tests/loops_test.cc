// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Loops in whole sessions: a tracker that drifts, a place that is seen again.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <functional>

#include "recording.h"
#include "sgs/loops/loop_closer.h"
#include "sgs/slam/loop_back_end.h"
#include "sgs/slam/session.h"
#include "sgs/tracker/test_drifting_tracker.h"

namespace sgs {
namespace {

/// A desk that is looked at from one end to the other and back, 20 s at 10 frames a second.
const Recording& desk() {
  static const Recording recording = [] {
    synthetic::SynthOptions options;
    options.scene = "room_desk";
    options.rate_hz = 10;
    options.frames = 190;
    options.threads = 2;
    options.camera = {320, 240, 267.7, 269.6, 159.8, 123.55};
    return record(options);
  }();
  return recording;
}

std::shared_ptr<history::ViewStore> new_store() {
  return std::make_shared<history::ViewStore>(history::HistoryConfig{});
}

slam::SessionConfig config_with_loops() {
  auto config = slam::make_session_config(slam::Preset::kDefault);
  config.mapper.iterations_per_frame = 0.5;
  config.loops.view_distance = 0.12;
  return config;
}

/// Half a degree and a centimetre a metre, three times over: the way is short.
std::unique_ptr<tracker::Tracker> drifting(const slam::SessionConfig& config,
                                           const PinholeCamera& camera) {
  auto tracker = tracker::make_tracker(config.tracker, camera, SE3{});
  EXPECT_TRUE(tracker);
  return std::make_unique<tracker::DriftingTracker>(std::move(*tracker),
                                                    tracker::DriftingTracker::Drift{0.03, 1.5}, 4);
}

struct Outcome {
  std::vector<map::Gaussian> gaussians;
  Trajectory final_poses, online;
  loops::LoopCounts loops;
  int frames_with_corrections = 0;
};

Outcome run(slam::SessionConfig config, int threads, bool live = false) {
  const Recording& recording = desk();
  slam::SessionOptions options;
  options.threads = threads;
  options.live = live;
  auto session =
      slam::Session::create(config, recording.camera, options, drifting(config, recording.camera));
  EXPECT_TRUE(session) << session.error().text();
  Outcome out;
  for (const auto& frame : recording.frames) {
    out.frames_with_corrections += (*session)->feed(frame).correction_m > 0 ? 1 : 0;
  }
  (*session)->finish();
  out.gaussians = (*session)->final_snapshot()->gaussians;
  out.final_poses = (*session)->trajectory();
  out.online = (*session)->online_trajectory();
  out.loops = (*session)->loop_counts().value_or(loops::LoopCounts{});
  return out;
}

TEST(Loops, TakeDriftAwayAndKeepWhatWasSaidLive) {
  const Outcome closed = run(config_with_loops(), 2);
  EXPECT_GE(closed.loops.accepted, 2);
  EXPECT_GE(closed.frames_with_corrections, 1);
  slam::SessionConfig open_config = config_with_loops();
  open_config.loops.enabled = false;
  const Outcome open = run(open_config, 2);
  EXPECT_EQ(open.loops.accepted, 0);
  EXPECT_EQ(open.frames_with_corrections, 0);
  const Trajectory& truth = desk().truth;
  EXPECT_LT(ate_m(closed.final_poses, truth), 0.6 * ate_m(open.final_poses, truth));
  EXPECT_LT(ate_m(closed.final_poses, truth), ate_m(closed.online, truth));
  ASSERT_EQ(closed.online.size(), desk().frames.size());
}

TEST(Loops, GiveTheSameBitsForAnyNumberOfThreads) {
  const Outcome one = run(config_with_loops(), 1);
  ASSERT_GE(one.frames_with_corrections, 1);
  for (const int threads : {2, 5}) {
    const Outcome other = run(config_with_loops(), threads);
    ASSERT_EQ(one.gaussians.size(), other.gaussians.size()) << threads;
    EXPECT_EQ(std::memcmp(one.gaussians.data(), other.gaussians.data(),
                          one.gaussians.size() * sizeof(map::Gaussian)),
              0);
    for (std::size_t i = 0; i < one.final_poses.size(); ++i) {
      ASSERT_EQ(one.final_poses.poses()[i].T_world_camera.t,
                other.final_poses.poses()[i].T_world_camera.t)
          << threads << " threads, pose " << i;
    }
  }
}

TEST(Loops, LoseNoFrameAndNoMapLive) {
  const Outcome live = run(config_with_loops(), 2, true);
  EXPECT_EQ(live.final_poses.size(), desk().frames.size());
  EXPECT_FALSE(live.gaussians.empty());
}

TEST(Loops, APlaceThatNeverComesBackIsNoLoop) {
  slam::SessionConfig config = config_with_loops();
  config.loops.min_gap_s = 1000;
  EXPECT_EQ(run(config, 2).loops.compared, 0);
}

/// What a closer without loops makes of the desk's frames when each motion of the truth comes
/// `stretch` times as long and turned by `turn_rad` more per metre, and once a step of `step_m` to
/// the side.
struct Mending {
  int mended = 0, nodes = 0;
  /// ATE of the frames as said, as they are at once, and with all corrections.
  double said_m = 0, online_m = 0, mended_m = 0;
};

Mending mend(double stretch, double turn_rad, double step_m = 0, double doubt_share = 0.33) {
  slam::SessionConfig config = config_with_loops();
  config.loops.doubt_share = doubt_share;
  config.loops.min_gap_s = 1000;
  loops::LoopCloser closer(config.loops, slam::pair_config(config.tracker), 0, new_store());
  SE3 T_said, T_now, T_true_last;
  history::Revision now;
  std::vector<StampedPose> said, online;
  for (const auto& frame : desk().frames) {
    const SE3& T_true = *frame->truth_T_world_camera;
    if (said.empty()) {
      T_said = T_now = T_true;
    } else {
      SE3 motion = T_true_last.inverse() * T_true;
      motion = SE3(motion.R * so3_exp({0, turn_rad * motion.t.norm(), 0}), stretch * motion.t);
      if (said.size() == desk().frames.size() / 2) motion.t.x() += step_m;
      T_said = T_said * motion;
      T_now = T_now * motion;
    }
    T_true_last = T_true;
    said.push_back({frame->timestamp_s, T_said});
    online.push_back({frame->timestamp_s, T_now});
    now.path.append({frame->index, frame->timestamp_s, T_now});
    tracker::TrackResult result;
    result.T_odom_camera = T_now;
    result.information = 1e7 * Matrix6d::Identity();
    const auto correction = closer.add(*frame, slam::tracked_frame(result), now);
    if (!correction) continue;
    now = history::revised(now, {*correction});
    T_now = now.path.back().T_odom_camera;
  }
  std::vector<StampedPose> corrected;
  for (std::size_t k = 0; k < now.path.size(); ++k) {
    corrected.push_back({now.path[k].timestamp_s, now.path[k].T_odom_camera});
  }
  const auto error_m = [](const std::vector<StampedPose>& poses) {
    return ate_m(Trajectory(poses), desk().truth);
  };
  return {closer.counts().re_estimated, closer.pose_graph().size(), error_m(said), error_m(online),
          error_m(corrected)};
}

TEST(Loops, AWayThatTheViewsContradictIsMended) {
  const Mending m = mend(1.02, 0.03);
  EXPECT_GE(m.mended, 5);
  EXPECT_LT(m.mended_m, 0.4 * m.said_m);
  EXPECT_LT(m.online_m, 0.6 * m.said_m);  // not only when all is over
}

TEST(Loops, NodesComeCloserWhileWaysAreMended) {
  const Mending closer = mend(1.02, 0.03), as_usual = mend(1.02, 0.03, 0, 1);
  EXPECT_GE(closer.nodes, 3 * as_usual.nodes / 2);
  EXPECT_EQ(mend(1, 0).nodes, mend(1, 0, 0, 1).nodes);
}

TEST(Loops, AWayThatTheViewsConfirmIsLeftAlone) {
  const Mending m = mend(1, 0);
  EXPECT_EQ(m.mended, 0);
  EXPECT_EQ(m.mended_m, m.said_m);
}

TEST(Loops, ASingleStepToOldSurfacesIsNotUndone) {
  const Mending m = mend(1, 0, 0.01);
  EXPECT_EQ(m.mended, 0);
  EXPECT_EQ(m.mended_m, m.said_m);
}

/// Loops between the first and the second half of the desk's frames when they come with these
/// poses.
int loops_across(const std::function<SE3(const RgbdFrame&, std::size_t)>& pose_of) {
  const slam::SessionConfig config = config_with_loops();
  loops::LoopCloser closer(config.loops, slam::pair_config(config.tracker), 0, new_store());
  history::Revision now;
  std::size_t i = 0;
  for (const auto& frame : desk().frames) {
    tracker::TrackResult result;
    result.T_odom_camera = pose_of(*frame, i++);
    result.information = 1e7 * Matrix6d::Identity();
    now.path.append({frame->index, frame->timestamp_s, result.T_odom_camera});
    if (const auto c = closer.add(*frame, slam::tracked_frame(result), now))
      now = history::revised(now, {*c});
  }
  const loops::PoseGraph& s = closer.pose_graph();
  const double half_s = desk().frames[desk().frames.size() / 2]->timestamp_s;
  return static_cast<int>(
      std::count_if(s.loops().begin(), s.loops().end(), [&](const graph::Edge& e) {
        return s.node(e.from).timestamp_s <= half_s && s.node(e.to).timestamp_s > half_s;
      }));
}

TEST(Loops, PlacesThatOnlyLookAlikeAreNotJoined) {
  // The second half of the recording is told to lie two metres further: the same pictures, so
  // another room that looks the same to the last detail.
  const int wrong = loops_across([](const RgbdFrame& frame, std::size_t i) {
    SE3 T = *frame.truth_T_world_camera;
    if (i > desk().frames.size() / 2) T.t.x() += 2;
    return T;
  });
  EXPECT_EQ(wrong, 0);
  const int right =
      loops_across([](const RgbdFrame& frame, std::size_t) { return *frame.truth_T_world_camera; });
  EXPECT_GE(right, 2);
}

TEST(Loops, TrackersThatSayNothingOfTheirCertaintyAreLeftAlone) {
  const slam::SessionConfig config = config_with_loops();
  loops::LoopCloser closer(config.loops, slam::pair_config(config.tracker), 0, new_store());
  history::Revision now;
  for (const auto& frame : desk().frames) {
    now.path.append({frame->index, frame->timestamp_s, {}});
    EXPECT_FALSE(closer.add(*frame, {}, now));
  }
  EXPECT_EQ(closer.pose_graph().size(), 0);
}

}  // namespace
}  // namespace sgs
