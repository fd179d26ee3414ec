// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// A depth camera that lies, calibrated while the session runs.
#include <gtest/gtest.h>

#include <cstring>
#include <future>

#include "recording.h"
#include "sgs/slam/session.h"
#include "sgs/synthetic/sensor.h"

namespace sgs {
namespace {

/// A walk through a corridor, 17 s at 15 frames a second.
const Recording& corridor() {
  static const Recording recording = [] {
    synthetic::SynthOptions options;
    options.scene = "corridor";
    options.level = "hard";
    options.rate_hz = 15;
    options.frames = 250;
    options.threads = 2;
    return record(options);
  }();
  return recording;
}

slam::SessionConfig config_with_calibration(bool online) {
  auto config = slam::make_session_config(slam::Preset::kDefault);
  config.mapper.iterations_per_frame = 0.1;
  config.backend.calibration.online = online;
  config.backend.calibration.lag = 20;
  return config;
}

struct Outcome {
  std::vector<map::Gaussian> gaussians;
  Trajectory poses;
  std::optional<DepthCalibration> calibration;
  int learned = 0;
};

Outcome run(const Recording& recording, const slam::SessionConfig& config, int threads,
            bool live = false) {
  slam::SessionOptions options;
  options.threads = threads;
  options.live = live;
  auto session = slam::Session::create(config, recording.camera, options);
  EXPECT_TRUE(session) << session.error().text();
  Outcome out;
  for (const auto& frame : recording.frames) out.learned = (*session)->feed(frame).calibrations;
  (*session)->finish();
  out.gaussians = (*session)->final_snapshot()->gaussians;
  out.poses = (*session)->trajectory();
  out.calibration = (*session)->calibration();
  return out;
}

TEST(OnlineCalibration, MakesThePathTruer) {
  const Recording& recording = corridor();
  const Outcome as_is = run(recording, config_with_calibration(false), 2);
  EXPECT_FALSE(as_is.calibration);
  const Outcome calibrated = run(recording, config_with_calibration(true), 2);
  ASSERT_TRUE(calibrated.calibration);
  EXPECT_LT(ate_m(calibrated.poses, recording.truth), 0.6 * ate_m(as_is.poses, recording.truth));
  const synthetic::Sensor sensor(synthetic::SensorModel::of_level("hard"), recording.camera, 1);
  EXPECT_LT((calibrated.calibration->shift_px - sensor.registration_shift()).norm(), 0.5);
}

TEST(OnlineCalibration, GivesTheSameBitsForAnyNumberOfThreads) {
  const Outcome one = run(corridor(), config_with_calibration(true), 1);
  ASSERT_GE(one.learned, 1);
  for (const int threads : {2, 5}) {
    const Outcome other = run(corridor(), config_with_calibration(true), threads);
    ASSERT_EQ(one.gaussians.size(), other.gaussians.size()) << threads;
    EXPECT_EQ(std::memcmp(one.gaussians.data(), other.gaussians.data(),
                          one.gaussians.size() * sizeof(map::Gaussian)),
              0)
        << threads;
    ASSERT_EQ(*one.calibration, *other.calibration);
  }
}

// Saved before anything was learned and after it; at the end it is learned again.
TEST(OnlineCalibration, IsThereAgainWhereASessionGoesOn) {
  const Recording& recording = corridor();
  auto config = config_with_calibration(true);
  config.mapper.memory_mb = 1;  // pictures that are on the disk change, too
  slam::SessionOptions options;
  options.threads = 2;
  auto whole = slam::Session::create(config, recording.camera, options);
  ASSERT_TRUE(whole) << whole.error().text();
  std::vector<std::future<std::string>> states;
  std::vector<int> learned;
  for (std::size_t i = 0; i < recording.frames.size(); ++i) {
    learned.push_back((*whole)->feed(recording.frames[i]).calibrations);
    if (i == 60 || i == 220) states.push_back((*whole)->save());
  }
  (*whole)->finish();
  ASSERT_GE(learned[220], 1);
  const auto expected = (*whole)->final_snapshot();
  for (auto& state : states) {
    options.threads = 1;
    auto again = slam::Session::create(config, recording.camera, options);
    ASSERT_TRUE(again) << again.error().text();
    const auto restored = (*again)->restore(state.get());
    ASSERT_TRUE(restored) << restored.error().text();
    for (const auto& frame : recording.frames) (*again)->feed(frame);
    EXPECT_FALSE((*again)->replay_differs_at());
    (*again)->finish();
    const auto actual = (*again)->final_snapshot();
    ASSERT_EQ(actual->gaussians.size(), expected->gaussians.size());
    EXPECT_EQ(std::memcmp(actual->gaussians.data(), expected->gaussians.data(),
                          expected->gaussians.size() * sizeof(map::Gaussian)),
              0);
    EXPECT_TRUE((*again)->calibration() == (*whole)->calibration());
    const Trajectory poses = (*again)->trajectory(), wanted = (*whole)->trajectory();
    ASSERT_EQ(poses.size(), wanted.size());
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      ASSERT_TRUE(poses.poses()[i].T_world_camera.t == wanted.poses()[i].T_world_camera.t) << i;
    }
  }
}

TEST(OnlineCalibration, LosesNoFrameAndNoMapLive) {
  const Outcome live = run(corridor(), config_with_calibration(true), 2, true);
  EXPECT_EQ(live.poses.size(), corridor().frames.size());
  EXPECT_FALSE(live.gaussians.empty());
}

}  // namespace
}  // namespace sgs
