// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Sessions that go on from a saved state, whose past is corrected by loops and by what is learned
// of the depth camera: before the state was saved, after it, and in between.
#include <gtest/gtest.h>

#include <cstring>
#include <future>
#include <iterator>
#include <map>

#include "recording.h"
#include "sgs/slam/session.h"

namespace sgs {
namespace {

/// A desk that is looked at from one end to the other and back.
synthetic::SynthOptions desk_there_and_back() {
  synthetic::SynthOptions options;
  options.scene = "room_desk";
  options.level = "hard";
  options.rate_hz = 10;
  options.frames = 190;
  options.threads = 2;
  options.camera = {320, 240, 267.7, 269.6, 159.8, 123.55};
  return options;
}

/// A walk whose pictures tell enough of a depth camera that is wrong.
synthetic::SynthOptions walk() {
  synthetic::SynthOptions options;
  options.scene = "corridor";
  options.level = "hard";
  options.rate_hz = 15;
  options.frames = 250;
  options.threads = 2;
  return options;
}

slam::SessionConfig config_with_corrections() {
  auto config = slam::make_session_config(slam::Preset::kDefault);
  config.mapper.iterations_per_frame = 0.1;
  config.history.memory_mb = 1;  // what is on the disk is calibrated, too
  config.mapper.schedule.most_keyframes = 12;
  config.loops.view_distance = 0.12;
  config.backend.calibration.online = true;
  config.backend.calibration.lag = 20;
  return config;
}

std::unique_ptr<slam::Session> new_session(const Recording& recording, int threads) {
  slam::SessionOptions options;
  options.threads = threads;
  auto session = slam::Session::create(config_with_corrections(), recording.camera, options);
  EXPECT_TRUE(session) << session.error().text();
  return std::move(*session);
}

/// A session that was not stopped, and its states behind some frames (by their number): early, and
/// around the first and the last correction of the past.
struct Whole {
  std::unique_ptr<slam::Session> session;
  std::map<std::size_t, std::string> states;
  int loops = 0, calibrations = 0;  // corrections on the way
};

Whole run_whole(const Recording& recording, int threads) {
  constexpr std::size_t kEarly = 30;
  Whole whole{new_session(recording, threads), {}};
  slam::Session& session = *whole.session;
  std::future<std::string> before;
  for (std::size_t i = 0; i < recording.frames.size(); ++i) {
    const auto known = session.calibration();
    const bool corrected = session.feed(recording.frames[i]).correction_m > 0;
    auto state = session.save();
    if (corrected) {
      ++(session.calibration() == known ? whole.loops : whole.calibrations);
      if (!whole.states.contains(i - 1)) whole.states[i - 1] = before.get();
    }
    if (corrected || i == kEarly) {
      whole.states[i] = state.get();
    } else {
      before = std::move(state);
    }
  }
  session.finish();
  constexpr std::size_t kFirst = 3, kMost = 5;
  while (whole.states.size() > kMost) whole.states.erase(std::next(whole.states.begin(), kFirst));
  return whole;
}

void expect_same(const slam::Session& actual, const slam::Session& wanted) {
  const auto a = actual.final_snapshot(), b = wanted.final_snapshot();
  ASSERT_EQ(a->gaussians.size(), b->gaussians.size());
  EXPECT_EQ(std::memcmp(a->gaussians.data(), b->gaussians.data(),
                        b->gaussians.size() * sizeof(map::Gaussian)),
            0);
  EXPECT_TRUE(actual.calibration() == wanted.calibration());
  const auto same = [](const Trajectory& one, const Trajectory& other) {
    if (one.size() != other.size()) return false;
    for (std::size_t i = 0; i < one.size(); ++i) {
      const SE3 &T = one.poses()[i].T_world_camera, &U = other.poses()[i].T_world_camera;
      if (!(T.t == U.t && T.R == U.R)) return false;
    }
    return true;
  };
  EXPECT_TRUE(same(actual.trajectory(), wanted.trajectory()));
  EXPECT_TRUE(same(actual.online_trajectory(), wanted.online_trajectory()));
  EXPECT_TRUE(same(actual.keyframe_trajectory(), wanted.keyframe_trajectory()));
}

/// Goes on from each state that was saved.
void go_on_from_each(const Recording& recording, const Whole& whole) {
  int threads = 2;
  for (const auto& [last, state] : whole.states) {
    SCOPED_TRACE("saved behind frame " + std::to_string(last));
    const auto again = new_session(recording, threads);
    threads = 1;
    const auto restored = again->restore(state);
    ASSERT_TRUE(restored) << restored.error().text();
    EXPECT_EQ(again->left_to_replay(), last + 1);
    for (const auto& frame : recording.frames) again->feed(frame);
    EXPECT_FALSE(again->replay_differs_at());
    again->finish();
    expect_same(*again, *whole.session);
  }
}

TEST(GoingOn, ComesToTheSameBitsWhereverLoopsCorrectThePast) {
  const Recording recording = record(desk_there_and_back());
  const Whole whole = run_whole(recording, 1);
  ASSERT_GE(whole.loops, 1);
  go_on_from_each(recording, whole);
}

TEST(GoingOn, ComesToTheSameBitsWhereverDepthIsCalibrated) {
  const Recording recording = record(walk());
  const Whole whole = run_whole(recording, 1);
  ASSERT_GE(whole.calibrations, 1);
  go_on_from_each(recording, whole);
}

// Where poses are given, nothing that is tracked tells that the depth images are others.
TEST(GoingOn, OtherDepthUnderGivenPosesIsFoundOut) {
  synthetic::SynthOptions options = desk_there_and_back();
  options.frames = 6;
  const Recording recording = record(options);
  const auto feed = [&](slam::Session& session, float depth_factor) {
    for (const auto& frame : recording.frames) {
      auto given = std::make_shared<RgbdFrame>(*frame);
      given->given_T_world_camera = SE3{};
      for (std::size_t k = 0; k < given->depth.size(); ++k) given->depth.data()[k] *= depth_factor;
      session.feed(given);
    }
  };
  const auto session_of_given_poses = [&] {
    auto config = config_with_corrections();
    config.tracker.type = tracker::TrackerType::kGiven;
    auto session = slam::Session::create(config, recording.camera, {});
    EXPECT_TRUE(session);
    return std::move(*session);
  };
  const auto before = session_of_given_poses();
  feed(*before, 1);
  const std::string state = before->save().get();
  const auto same = session_of_given_poses(), other = session_of_given_poses();
  ASSERT_TRUE(same->restore(state));
  ASSERT_TRUE(other->restore(state));
  feed(*same, 1);
  EXPECT_FALSE(same->replay_differs_at());
  feed(*other, 1.01f);
  EXPECT_EQ(other->replay_differs_at(), 0u);
}

}  // namespace
}  // namespace sgs
