// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// A depth camera that lies, calibrated while the session runs.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "recording.h"
#include "sgs/camera/fingerprint.h"
#include "sgs/slam/session.h"
#include "sgs/synthetic/sensor.h"

namespace sgs {
namespace {

/// A walk through a corridor, 17 s at 15 frames a second.
Recording walk(std::uint64_t seed) {
  synthetic::SynthOptions options;
  options.scene = "corridor";
  options.level = "hard";
  options.rate_hz = 15;
  options.frames = 250;
  options.seed = seed;
  options.threads = 2;
  return record(options);
}

const Recording& corridor() {
  static const Recording recording = walk(1);
  return recording;
}

slam::SessionConfig config_with_calibration(bool online) {
  auto config = slam::make_session_config(slam::Preset::kDefault);
  config.mapper.iterations_per_frame = 0.1;
  config.backend.calibration.online = online;
  config.backend.calibration.lag = 20;
  return config;
}

struct CalibratedRun {
  std::vector<map::Gaussian> gaussians;
  Trajectory poses;
  std::optional<DepthCalibration> calibration;
  int learned = 0;
  std::vector<std::int64_t> fingerprints;  // that the records have
};

CalibratedRun run(const Recording& recording, const slam::SessionConfig& config, int threads,
                  bool live = false) {
  slam::SessionOptions options;
  options.threads = threads;
  options.live = live;
  auto session = slam::Session::create(config, recording.camera, options);
  EXPECT_TRUE(session) << session.error().text();
  CalibratedRun out;
  for (const auto& frame : recording.frames) {
    const slam::FrameRecord& record = (*session)->feed(frame);
    out.learned = record.calibrations;
    out.fingerprints.push_back(record.fingerprint);
  }
  (*session)->finish();
  out.gaussians = (*session)->final_snapshot()->gaussians;
  out.poses = (*session)->trajectory();
  out.calibration = (*session)->calibration();
  return out;
}

// What several of the tests look at, run once.
const CalibratedRun& corridor_calibrated() {
  static const CalibratedRun calibrated = run(corridor(), config_with_calibration(true), 2);
  return calibrated;
}

TEST(OnlineCalibration, MakesThePathTruer) {
  const Recording& recording = corridor();
  const CalibratedRun as_is = run(recording, config_with_calibration(false), 2);
  EXPECT_FALSE(as_is.calibration);
  const CalibratedRun& calibrated = corridor_calibrated();
  ASSERT_TRUE(calibrated.calibration);
  EXPECT_LT(ate_m(calibrated.poses, recording.truth), 0.6 * ate_m(as_is.poses, recording.truth));
}

// Which keyframes there are is up to the path, and moves the shift of one camera by half of its
// deviation: so the mean of three is held to half a pixel, and each to what it says of itself.
TEST(OnlineCalibration, LearnsWhereDepthLiesInThePicture) {
  constexpr int kCameras = 3;
  double off_px = 0;
  for (std::uint64_t seed = 1; seed <= kCameras; ++seed) {
    const CalibratedRun calibrated =
        seed == 1 ? corridor_calibrated() : run(walk(seed), config_with_calibration(true), 2);
    ASSERT_TRUE(calibrated.calibration) << seed;
    const synthetic::Sensor sensor(synthetic::SensorModel::of_level("hard", seed),
                                   corridor().camera, seed);
    const DepthCalibration& learned = *calibrated.calibration;
    const Eigen::Vector2d off = learned.shift_px - sensor.registration_shift();
    off_px += off.norm() / kCameras;
    for (int axis = 0; axis < 2; ++axis) {
      EXPECT_LT(learned.shift_sigma_px[axis], 0.5) << seed << " " << axis;
      EXPECT_LT(std::abs(off[axis]), 2 * learned.shift_sigma_px[axis]) << seed << " " << axis;
    }
  }
  EXPECT_LT(off_px, 0.5);
}

TEST(OnlineCalibration, GivesTheSameBitsForAnyNumberOfThreads) {
  const CalibratedRun one = run(corridor(), config_with_calibration(true), 1);
  ASSERT_GE(one.learned, 1);
  for (const int threads : {2, 5}) {
    const CalibratedRun other = threads == 2
                                    ? corridor_calibrated()
                                    : run(corridor(), config_with_calibration(true), threads);
    ASSERT_EQ(one.gaussians.size(), other.gaussians.size()) << threads;
    EXPECT_EQ(std::memcmp(one.gaussians.data(), other.gaussians.data(),
                          one.gaussians.size() * sizeof(map::Gaussian)),
              0)
        << threads;
    ASSERT_EQ(*one.calibration, *other.calibration);
  }
}

TEST(OnlineCalibration, FingerprintsAreOfFramesAsRecorded) {
  const CalibratedRun& calibrated = corridor_calibrated();
  ASSERT_EQ(calibrated.fingerprints.size(), corridor().frames.size());
  for (std::size_t i = 0; i < calibrated.fingerprints.size(); ++i) {
    ASSERT_EQ(calibrated.fingerprints[i], fingerprint(*corridor().frames[i])) << i;
  }
  EXPECT_GE(calibrated.learned, 1);
}

TEST(OnlineCalibration, LosesNoFrameAndNoMapLive) {
  const CalibratedRun live = run(corridor(), config_with_calibration(true), 2, true);
  EXPECT_EQ(live.poses.size(), corridor().frames.size());
  EXPECT_FALSE(live.gaussians.empty());
}

}  // namespace
}  // namespace sgs
