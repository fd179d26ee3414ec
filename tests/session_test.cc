// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/slam/session.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/sinks/null_sink.h>
#include <spdlog/sinks/ostream_sink.h>

#include <algorithm>
#include <cstring>
#include <sstream>
#include <thread>

#include "sgs/core/log.h"
#include "sgs/eval/trajectory_metrics.h"
#include "sgs/slam/live_feed.h"
#include "sgs/synthetic/source.h"

namespace sgs {
namespace {

using testing::HasSubstr;

/// A short, small sequence: enough for several keyframes, quick under sanitizers.
std::vector<std::shared_ptr<const RgbdFrame>> small_sequence(int count) {
  synthetic::SynthOptions options;
  options.scene = "room_desk";
  options.frames = count;
  options.camera = {320, 240, 267.7, 269.6, 159.8, 123.55};
  auto source = synthetic::make_synthetic_source(options);
  EXPECT_TRUE(source) << source.error().text();
  std::vector<std::shared_ptr<const RgbdFrame>> frames;
  while (auto item = dataset::read_item(**source)) frames.push_back(item->frame);
  return frames;
}

slam::SessionConfig session_config() {
  auto config = slam::make_session_config(slam::Preset::kDefault);
  config.mapper.iterations_per_frame = 1.5;
  config.keyframe_interval = 4;
  return config;
}

struct SessionRun {
  std::vector<map::Gaussian> gaussians;
  std::vector<StampedPose> poses;
};

SessionRun run(const std::vector<std::shared_ptr<const RgbdFrame>>& frames,
               const slam::SessionConfig& config, int threads, bool live = false) {
  slam::SessionOptions options;
  options.threads = threads;
  options.live = live;
  auto session = slam::Session::create(config, frames.front()->camera, options);
  EXPECT_TRUE(session) << session.error().text();
  for (const auto& frame : frames) (*session)->feed(frame);
  (*session)->finish();
  return {(*session)->snapshot()->gaussians, (*session)->trajectory().poses()};
}

void expect_same_bits(const SessionRun& a, const SessionRun& b) {
  ASSERT_EQ(a.gaussians.size(), b.gaussians.size());
  EXPECT_EQ(std::memcmp(a.gaussians.data(), b.gaussians.data(),
                        a.gaussians.size() * sizeof(map::Gaussian)),
            0);
  ASSERT_EQ(a.poses.size(), b.poses.size());
  for (std::size_t i = 0; i < a.poses.size(); ++i) {
    EXPECT_EQ(a.poses[i].T_world_camera.t, b.poses[i].T_world_camera.t) << i;
    EXPECT_EQ(a.poses[i].T_world_camera.R, b.poses[i].T_world_camera.R) << i;
  }
}

/// Frames of a camera that stands: of an empty room, then of two people in it.
std::vector<std::shared_ptr<const RgbdFrame>> walked_through(int empty, int crowded,
                                                             std::uint64_t seed = 1) {
  std::vector<std::shared_ptr<const RgbdFrame>> frames;
  const auto add = [&](const char* input, int count) {
    auto options = *synthetic::parse_synth_spec(input);
    options.frames = count;
    options.seed = seed;
    options.camera = {320, 240, 267.7, 269.6, 159.8, 123.55};
    auto source = synthetic::make_synthetic_source(options);
    EXPECT_TRUE(source) << source.error().text();
    while (auto item = dataset::read_item(**source)) {
      auto frame = std::make_shared<RgbdFrame>(*item->frame);
      frame->index = static_cast<std::int64_t>(frames.size());
      frame->timestamp_s = static_cast<double>(frames.size()) / 30;
      frames.push_back(std::move(frame));
    }
  };
  if (empty > 0) add("synth:room+still:kinect", empty);
  add("synth:room+walkers40+still:kinect", crowded);
  return frames;
}

/// How far a camera that stands still is said to have been from where it began.
double largest_way_m(const SessionRun& done) {
  double largest_m = 0;
  for (const StampedPose& pose : done.poses) {
    const SE3 T = done.poses.front().T_world_camera.inverse() * pose.T_world_camera;
    largest_m = std::max(largest_m, T.t.norm());
  }
  return largest_m;
}

// Not every crowd takes the camera along: the farthest of three.
TEST(Session, WhoWalksThroughAKnownRoomHardlyMovesTheCamera) {
  auto config = session_config();
  config.mapper.iterations_per_frame = 0;
  config.tracker.movers.clusters = false;
  auto ignoring = config;
  ignoring.tracker.movers.ignore = ignoring.tracker.visual_keyframes.patient = true;
  double followed_m = 0, ignored_m = 0;
  for (const std::uint64_t seed : {1, 2, 3}) {
    const auto frames = walked_through(20, 20, seed);
    followed_m = std::max(followed_m, largest_way_m(run(frames, config, 1)));
    ignored_m = std::max(ignored_m, largest_way_m(run(frames, ignoring, 1)));
  }
  EXPECT_LT(ignored_m, followed_m / 5);
}

// Half of the view moves when nothing is known of the room yet.
TEST(Session, WhoWalksFromTheFirstFrameOnHardlyMovesTheCamera) {
  const auto frames = walked_through(0, 40);
  auto config = session_config();
  config.mapper.iterations_per_frame = 0;
  config.tracker.movers.clusters = false;
  const double followed_m = largest_way_m(run(frames, config, 1));
  config.tracker.movers.clusters = true;
  const double left_out_m = largest_way_m(run(frames, config, 1));
  EXPECT_LT(left_out_m, followed_m / 5);
}

// Points and their ellipses are left out together.
TEST(Session, WhoWalksIsLeftOutOfEllipsesToo) {
  const auto frames = walked_through(20, 20);
  auto config = session_config();
  config.mapper.iterations_per_frame = 0;
  config.tracker.movers.ignore = true;
  config.tracker.factor.type = registration::FactorType::kGicp;
  EXPECT_EQ(run(frames, config, 1).poses.size(), frames.size());
}

TEST(Session, SameBitsForAnyNumberOfThreads) {
  const auto frames = small_sequence(14);
  const auto config = session_config();
  const SessionRun one = run(frames, config, 1);
  EXPECT_GT(one.gaussians.size(), 100u);
  expect_same_bits(one, run(frames, config, 1));
  expect_same_bits(one, run(frames, config, 2));
  expect_same_bits(one, run(frames, config, 4));
}

/// With `render`, which tracks against the picture of the map.
slam::SessionConfig render_config() {
  auto config = session_config();
  config.tracker.type = tracker::TrackerType::kRender;
  return config;
}

TEST(Session, TrackingAgainstTheRenderedMapGivesTheSameBitsForAnyNumberOfThreads) {
  const auto frames = small_sequence(10);
  const SessionRun one = run(frames, render_config(), 1);
  expect_same_bits(one, run(frames, render_config(), 1));
  expect_same_bits(one, run(frames, render_config(), 2));
}

TEST(Session, TrackingAgainstTheRenderedMapMakesMoreMappingSteps) {
  const auto frames = small_sequence(8);
  const auto steps = [&](double least) {
    auto config = render_config();
    config.tracker.rendering.mapping_steps = least;
    config.snapshot_interval = 1;  // steps are counted up to the newest one
    slam::SessionOptions options;
    options.threads = 1;
    auto session = *slam::Session::create(config, frames.front()->camera, options);
    for (const auto& frame : frames) session->feed(frame);
    return session->records().back().iterations;
  };
  EXPECT_GE(steps(3), steps(0) + 9);  // 1.5 more in each of at least six frames
}

TEST(Session, TracksASyntheticRoom) {
  const auto frames = small_sequence(20);
  const SessionRun outcome = run(frames, session_config(), 2);
  Trajectory truth;
  for (const auto& frame : frames) {
    truth.push_back({frame->timestamp_s, *frame->truth_T_world_camera});
  }
  const auto scores =
      eval::evaluate_trajectory(eval::to_estimates(Trajectory(outcome.poses)), truth);
  ASSERT_TRUE(scores.ate);
  EXPECT_LT(scores.ate->rmse, 0.01);
}

// What the mapper moves its keyframes by is for its pictures.
TEST(Session, SaysTheTrackersPathWhateverTheMapperMakesOfIt) {
  const auto frames = small_sequence(14);
  auto config = session_config();
  config.mapper.refinement.pose_first_visit = 0;
  std::vector<Trajectory> paths, keyframes;
  for (const bool refine : {true, false}) {
    config.mapper.refinement.pose = refine;
    auto session = slam::Session::create(config, frames.front()->camera, {});
    ASSERT_TRUE(session) << session.error().text();
    for (const auto& frame : frames) (*session)->feed(frame);
    (*session)->finish();
    paths.push_back((*session)->trajectory());
    keyframes.push_back((*session)->keyframe_trajectory());
  }
  const auto distance = [](const std::vector<Trajectory>& two) {
    const SE3 &a = two[0].poses().back().T_world_camera, &b = two[1].poses().back().T_world_camera;
    return (a.t - b.t).norm();
  };
  EXPECT_EQ(distance(paths), 0);
  EXPECT_GT(distance(keyframes), 0);
}

TEST(Session, LiveModeMapsWithoutWaiting) {
  const auto frames = small_sequence(8);
  const SessionRun outcome = run(frames, session_config(), 2, true);
  EXPECT_GT(outcome.gaussians.size(), 100u);
  EXPECT_EQ(outcome.poses.size(), frames.size());
}

TEST(Session, HasACoreToItselfWhileItTracks) {
  const auto frames = small_sequence(6);
  slam::SessionOptions options;
  for (const int threads : {1, static_cast<int>(std::thread::hardware_concurrency()) + 1}) {
    options.threads = threads;
    auto session = slam::Session::create(session_config(), frames.front()->camera, options);
    ASSERT_TRUE(session) << session.error().text();
    for (const auto& frame : frames) (*session)->feed(frame);
    (*session)->finish();
    const StageTimes times = (*session)->times();
    const auto& stages = times.stages();
    const auto waits = stages.find("wait for core");
    // A single thread takes turns between tracking and mapping.
    EXPECT_EQ(waits != stages.end(), threads > 1);
    if (waits != stages.end()) {
      EXPECT_EQ(waits->second.calls, frames.size());
    }
  }
}

TEST(Session, NeverMapsHeldOutFrames) {
  const auto frames = small_sequence(14);
  auto session = slam::Session::create(session_config(), frames.front()->camera, {});
  ASSERT_TRUE(session);
  for (const auto& frame : frames) (*session)->feed(frame);
  (*session)->finish();
  int heldout = 0;
  for (const auto& record : (*session)->records().all()) {
    EXPECT_EQ(record.heldout, record.index % 8 == 4);
    EXPECT_FALSE(record.heldout && record.mapping_keyframe);
    heldout += record.heldout;
  }
  EXPECT_EQ(heldout, 2);
}

/// Statuses of a run in which two frames in the middle have no depth.
std::vector<tracker::TrackingStatus> statuses_with_blind_frames(tracker::TrackerType type) {
  auto frames = small_sequence(10);
  for (std::size_t i = 4; i < 6; ++i) {
    auto blind = std::make_shared<RgbdFrame>(*frames[i]);
    blind->depth.fill(0);
    frames[i] = blind;
  }
  auto config = session_config();
  config.tracker.type = type;
  auto session = slam::Session::create(config, frames.front()->camera, {});
  EXPECT_TRUE(session);
  for (const auto& frame : frames) (*session)->feed(frame);
  (*session)->finish();
  std::vector<tracker::TrackingStatus> statuses;
  for (const auto& record : (*session)->records().all()) statuses.push_back(record.status);
  return statuses;
}

TEST(Session, GeometryAloneIsLostWithoutDepthAndComesBack) {
  const auto statuses = statuses_with_blind_frames(tracker::TrackerType::kGicp);
  EXPECT_EQ(statuses[4], tracker::TrackingStatus::kLost);
  EXPECT_EQ(statuses[5], tracker::TrackingStatus::kLost);
  EXPECT_NE(statuses.back(), tracker::TrackingStatus::kLost);
}

TEST(Session, VisionCarriesTheSpectralTrackerThroughMissingDepth) {
  const auto statuses = statuses_with_blind_frames(tracker::TrackerType::kSpectral);
  EXPECT_EQ(statuses[4], tracker::TrackingStatus::kDegenerate);
  EXPECT_EQ(statuses[5], tracker::TrackingStatus::kDegenerate);
  EXPECT_NE(statuses.back(), tracker::TrackingStatus::kLost);
}

TEST(Session, SaysOnceWhyTrackingIsLostAndOnceThatItIsBack) {
  std::ostringstream log;
  set_log_sinks({std::make_shared<spdlog::sinks::ostream_sink_mt>(log)});
  statuses_with_blind_frames(tracker::TrackerType::kGicp);
  set_log_sinks({std::make_shared<spdlog::sinks::null_sink_mt>()});
  const std::string text = log.str();
  EXPECT_THAT(text, HasSubstr("frame 4"));
  EXPECT_THAT(text, HasSubstr(std::string(explain(alignment::LostReason::kNoDepth))));
  EXPECT_THAT(text, HasSubstr("frame 6"));
  EXPECT_THAT(text, HasSubstr("back after 2 lost frames"));
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 2) << text;
}

TEST(Session, ReportsEveryFrame) {
  const auto frames = small_sequence(6);
  auto session = slam::Session::create(session_config(), frames.front()->camera, {});
  ASSERT_TRUE(session);
  std::vector<std::int64_t> seen;
  (*session)->on_frame([&](const slam::FrameRecord& record) { seen.push_back(record.index); });
  for (const auto& frame : frames) (*session)->feed(frame);
  (*session)->finish();
  EXPECT_EQ(seen, (std::vector<std::int64_t>{0, 1, 2, 3, 4, 5}));
}

TEST(Session, RefusesFramesOfAnotherSize) {
  auto session = slam::Session::create(session_config(), {320, 240, 260, 260, 160, 120}, {});
  ASSERT_TRUE(session);
  auto frame = std::make_shared<RgbdFrame>();
  frame->color = ColorImage(64, 48);
  frame->depth = DepthImage(64, 48);
  EXPECT_THROW((*session)->feed(frame), ContractViolation);
}

TEST(Session, SaysWhatIsWrongWithItsSettings) {
  EXPECT_FALSE(slam::make_session_config("no such preset"));
  EXPECT_FALSE(slam::Session::create(session_config(), PinholeCamera{}, {}));
  auto config = session_config();
  config.mapper.insertion.leaf_max_px = 1000;
  const auto session = slam::Session::create(config, {320, 240, 260, 260, 160, 120}, {});
  ASSERT_FALSE(session);
  EXPECT_THAT(session.error().message, HasSubstr("'mapper.insertion.leaf_max_px': '1000'"));
  EXPECT_THAT(session.error().remedy, HasSubstr("2 .. 128 px"));
  slam::SessionOptions options;
  options.threads = 0;
  EXPECT_FALSE(slam::Session::create(session_config(), {320, 240, 260, 260, 160, 120}, options));
}

TEST(SessionConfig, EveryPresetIsAllowedAndEveryFormerKeyLeadsSomewhere) {
  for (const auto& [preset, name] : enum_names(slam::Preset{})) {
    auto config = slam::make_session_config(name);
    ASSERT_TRUE(config) << config.error().text();
    EXPECT_EQ(config->preset, preset);
    EXPECT_TRUE(check(*config)) << check(*config).error().text();
    ParameterList list;
    config->declare(list);
    for (const FormerKey& former : list.former_keys()) {
      EXPECT_EQ(list.find(former.key), nullptr) << former.key << " is declared";
      const auto leads_there = [&](const Parameter& p) {
        return p.key == former.now || p.key.starts_with(former.now + ".");
      };
      const auto& known = list.parameters();
      EXPECT_TRUE(former.now.empty() || std::any_of(known.begin(), known.end(), leads_there))
          << former.key << " leads to " << former.now;
    }
  }
}

}  // namespace
}  // namespace sgs
