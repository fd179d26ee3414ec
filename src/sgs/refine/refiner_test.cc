// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/refine/refiner.h"

#include <gtest/gtest.h>

#include <cstring>

#include "sgs/mapper/mapper.h"
#include "sgs/mapper/test_wall_scene.h"

namespace sgs::refine {
namespace {

SE3 viewpoint(int i) { return mapper::translated(0.04 * i, 0.01 * (i % 3), 0); }

/// A map as a few steps of mapping leave it.
map::SplatMap rough_map() {
  mapper::MapperConfig config;
  config.first_keyframe_iterations = 5;
  mapper::Mapper mapper(config, mapper::small_camera(), 1, nullptr);
  mapper.add_keyframe(mapper::wall_frame(mapper::small_camera(), viewpoint(0)), viewpoint(0));
  return {mapper.snapshot()->gaussians, {}};
}

std::vector<RefineFrame> frames(int first, int end, int stride, const SE3& error = {}) {
  std::vector<RefineFrame> out;
  for (int i = first; i < end; i += stride) {
    const auto frame = mapper::wall_frame(mapper::small_camera(), viewpoint(i), i);
    const SE3 pose = i == 0 ? viewpoint(i) : viewpoint(i) * error;
    out.push_back({mapper::MapKeyframe(*frame, pose, 10), frame->timestamp_s, 1, 1});
  }
  return out;
}

/// As a camera takes them that closes its iris step by step.
std::vector<RefineFrame> darkening_frames(int first, int end, int stride) {
  std::vector<RefineFrame> out;
  for (int i = first; i < end; i += stride) {
    RgbdFrame frame = *mapper::wall_frame(mapper::small_camera(), viewpoint(i), i);
    const double gain = 1.1 - 0.04 * i;
    for (std::size_t k = 0; k < frame.color.size(); ++k) {
      Rgb8& c = frame.color.data()[k];
      for (std::uint8_t* channel : {&c.r, &c.g, &c.b}) {
        *channel = static_cast<std::uint8_t>(std::min(255.0, gain * *channel));
      }
    }
    out.push_back({mapper::MapKeyframe(frame, viewpoint(i), 10), frame.timestamp_s, 1, 1});
  }
  return out;
}

RefineConfig small_config() {
  RefineConfig config;
  config.max_gaussians = 3000;
  config.densify.interval = 20;
  config.checks = 6;
  return config;
}

Refined refine(const RefineConfig& config, const Budget& budget, int threads = 1) {
  ThreadPool pool(threads);
  Refiner refiner(config, 1, frames(0, 6, 2), frames(1, 6, 2), rough_map(), &pool);
  return refiner.run(budget);
}

TEST(Refiner, MakesHeldoutPicturesBetter) {
  const Refined refined = refine(small_config(), {150, 0});
  EXPECT_TRUE(refined.heldout);
  EXPECT_GT(refined.best.psnr_db, refined.start.psnr_db + 3);
  EXPECT_EQ(refined.best.gaussians, refined.gaussians.size());
  EXPECT_GT(refined.gaussians.size(), rough_map().gaussians.size());
}

TEST(Refiner, SameBitsForAnyNumberOfThreads) {
  const Refined one = refine(small_config(), {60, 0}, 1),
                three = refine(small_config(), {60, 0}, 3);
  ASSERT_EQ(one.gaussians.size(), three.gaussians.size());
  EXPECT_EQ(std::memcmp(one.gaussians.data(), three.gaussians.data(),
                        one.gaussians.size() * sizeof(map::Gaussian)),
            0);
  EXPECT_EQ(one.best.psnr_db, three.best.psnr_db);
}

// Rates that destroy the map: what comes out is what went in.
TEST(Refiner, NeverWorseThanWhatItStartedFrom) {
  RefineConfig config = small_config();
  config.optimizer.rate_mean_m = 0.5;
  config.optimizer.rate_color = 1;
  config.rate_end = 1;
  const auto before = rough_map().gaussians;
  const Refined refined = refine(config, {40, 0});
  EXPECT_EQ(refined.best.steps, 0);
  ASSERT_EQ(refined.gaussians.size(), before.size());
  EXPECT_EQ(
      std::memcmp(refined.gaussians.data(), before.data(), before.size() * sizeof(map::Gaussian)),
      0);
}

TEST(Refiner, EndsWhenNothingImproves) {
  RefineConfig config = small_config();
  config.optimizer.rate_mean_m = 0.5;
  config.rate_end = 1;
  config.checks = 100;
  config.patience = 3;
  const Refined refined = refine(config, {2000, 0});
  EXPECT_TRUE(refined.exhausted);
  EXPECT_LT(refined.last.steps, 2000);
}

/// How far a map that is already good falls in its first ten steps, in dB.
double early_fall_db(const map::SplatMap& map, int warmup_steps) {
  RefineConfig config = small_config();
  config.warmup_steps = warmup_steps;
  config.checks = 100;
  Refiner refiner(config, 1, frames(0, 6, 2), frames(1, 6, 2), map, nullptr);
  double fall = 0, start = 0;
  refiner.run({1000, 0}, [&](const Evaluation& now) {
    if (now.steps == 0) start = now.psnr_db;
    if (now.steps <= 20) fall = std::max(fall, start - now.psnr_db);
  });
  return fall;
}

TEST(Refiner, WarmsUpSoThatAGoodMapIsNotSpoiledFirst) {
  const map::SplatMap good = {refine(small_config(), {150, 0}).gaussians, {}};
  EXPECT_LT(early_fall_db(good, 200), 0.5 * early_fall_db(good, 0));
}

// What is learnt begins below the map it comes from, and rises: that is no reason to end.
TEST(Refiner, DoesNotEndWhileItRises) {
  const map::SplatMap good = {refine(small_config(), {150, 0}).gaussians, {}};
  RefineConfig config = small_config();
  config.warmup_steps = 0;
  config.optimizer.rate_color = 0.5;
  config.checks = 10;
  config.patience = 3;
  Refiner refiner(config, 1, frames(0, 6, 2), frames(1, 6, 2), good, nullptr);
  std::vector<double> checks_db;
  const Refined refined =
      refiner.run({100, 0}, [&](const Evaluation& now) { checks_db.push_back(now.psnr_db); });
  ASSERT_GT(checks_db.size(), 4u);
  for (std::size_t k = 1; k <= 4; ++k) EXPECT_LT(checks_db[k], checks_db[0]) << k;
  EXPECT_FALSE(refined.exhausted);
}

TEST(Refiner, NoEffortChangesNothing) {
  const Refined refined = refine(small_config(), {0, 0});
  EXPECT_EQ(refined.last.steps, 0);
  EXPECT_EQ(refined.gaussians.size(), rough_map().gaussians.size());
}

TEST(Refiner, AStopKeepsTheBestSoFar) {
  RefineConfig config = small_config();
  config.checks = 1000;
  Refiner refiner(config, 1, frames(0, 6, 2), frames(1, 6, 2), rough_map(), nullptr);
  std::stop_source stop;
  const auto watch = [&](const Evaluation& now) {
    if (now.steps > 0) stop.request_stop();
  };
  const Refined refined = refiner.run({10000, 0}, watch, stop.get_token());
  EXPECT_TRUE(refined.stopped);
  EXPECT_LT(refined.last.steps, 10000);
  EXPECT_GE(refined.best.psnr_db, refined.start.psnr_db);
  EXPECT_FALSE(refined.gaussians.empty());
}

TEST(Refiner, WithNothingHeldOutTrainingFramesJudge) {
  Refiner refiner(small_config(), 1, frames(0, 1, 1), {}, rough_map(), nullptr);
  const Refined refined = refiner.run({50, 0});
  EXPECT_FALSE(refined.heldout);
  EXPECT_GE(refined.best.psnr_db, refined.start.psnr_db);
}

/// A wall that is brighter the more it is seen from the right.
std::vector<RefineFrame> shimmering_frames(int first, int end, int stride) {
  std::vector<RefineFrame> out;
  for (int i = first; i < end; i += stride) {
    RgbdFrame frame = *mapper::wall_frame(mapper::small_camera(), viewpoint(i), i);
    const double gain = 0.6 + 0.02 * i;
    for (std::size_t k = 0; k < frame.color.size(); ++k) {
      Rgb8& c = frame.color.data()[k];
      c.r = static_cast<std::uint8_t>(std::min(255.0, gain * c.r));
    }
    out.push_back({mapper::MapKeyframe(frame, viewpoint(i), 10), frame.timestamp_s, 1, 1});
  }
  return out;
}

Refined refine_shimmer(int harmonics, int threads) {
  RefineConfig config = small_config();
  config.harmonics = harmonics;
  config.keyframes.exposure = false;
  ThreadPool pool(threads);
  Refiner refiner(config, 1, shimmering_frames(0, 21, 4), shimmering_frames(2, 21, 4), rough_map(),
                  &pool);
  return refiner.run({300, 0});
}

TEST(Refiner, HarmonicsLearnColoursThatDependOnTheView) {
  const Refined without = refine_shimmer(0, 1), with = refine_shimmer(1, 1),
                threads = refine_shimmer(1, 3);
  EXPECT_TRUE(without.harmonics.empty());
  EXPECT_GT(with.best.psnr_db, without.best.psnr_db + 1);
  EXPECT_EQ(with.harmonics.size(), with.gaussians.size());
  EXPECT_EQ(with.harmonics.coefficients, threads.harmonics.coefficients);
}

// What a map comes with is kept, and learnt on.
TEST(Refiner, HarmonicsOfTheMapAreKept) {
  map::SplatMap map = rough_map();
  map.harmonics.degree = 2;
  map.harmonics.resize(map.gaussians.size());
  map.harmonics.of(3)[5] = 0.1f;
  for (const int degree : {0, 3}) {
    RefineConfig config = small_config();
    config.harmonics = degree;
    Refiner refiner(config, 1, frames(0, 6, 2), frames(1, 6, 2), map, nullptr);
    const Refined refined = refiner.run({0, 0});
    ASSERT_EQ(refined.harmonics.degree, std::max(2, degree));
    ASSERT_EQ(refined.harmonics.size(), map.gaussians.size());
    EXPECT_EQ(refined.harmonics.of(3)[5], 0.1f);
  }
}

// The held-out pictures' exposure is that of the frames around them, never looked up in them.
TEST(Refiner, LearnsHowTheExposureChanges) {
  RefineConfig config = small_config();
  config.keyframes.exposure_prior = 0.1;
  Refiner refiner(config, 1, darkening_frames(0, 7, 2), darkening_frames(1, 7, 2), rough_map(),
                  nullptr);
  const Refined refined = refiner.run({200, 0});
  const auto first = refined.exposures.at(0), last = refined.exposures.at(1e9);
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(last[c] / first[c], 0.86 / 1.1, 0.05) << c;
  EXPECT_GT(refined.last.psnr_exposed_db, refined.last.psnr_db + 1);
}

// Poses that are wrong come right, and what lies between them moves along.
TEST(Refiner, MovesPosesToWhereThePicturesFit) {
  RefineConfig config = small_config();
  config.keyframes.pose_prior_rotation *= 0.01;
  config.keyframes.pose_prior_translation *= 0.01;
  const SE3 error = mapper::translated(0.008, 0, 0);
  const auto distance = [](const SE3& pose, int i) { return (pose.t - viewpoint(i).t).norm(); };
  Refiner refiner(config, 1, frames(0, 6, 2, error), frames(1, 6, 2, error), rough_map(), nullptr);
  const Refined refined = refiner.run({200, 0});
  const SE3 wrong = viewpoint(3) * error;
  EXPECT_LT(distance(refined.correction.corrected(wrong, 0.3), 3), 0.6 * distance(wrong, 3));
}

}  // namespace
}  // namespace sgs::refine
