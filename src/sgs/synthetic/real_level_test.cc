// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sgs/camera/undistort.h"
#include "sgs/dataset/open.h"
#include "sgs/dataset/tum_writer.h"
#include "sgs/io/temporary_folder.h"
#include "sgs/synthetic/sensor_model.h"
#include "sgs/synthetic/test_frames.h"

namespace sgs::synthetic {
namespace {

SynthOptions small_camera(int frames, std::uint64_t seed = 1) {
  SynthOptions options;
  options.scene = "room_desk";
  options.level = "real";
  options.seed = seed;
  options.frames = frames;
  options.threads = 2;
  options.camera = {160, 120, 133.85, 134.8, 79.6, 61.5};
  return options;
}

template <class T>
bool equal_images(const Image<T>& a, const Image<T>& b) {
  return a.size() == b.size() && std::equal(a.data(), a.data() + a.size(), b.data());
}
bool equal_pixels(const RgbdFrame& a, const RgbdFrame& b) {
  return equal_images(a.color, b.color) && equal_images(a.depth, b.depth);
}

template <class T, class Is>
double share_of(const Image<T>& image, const Is& is) {
  return static_cast<double>(std::count_if(image.data(), image.data() + image.size(), is)) /
         static_cast<double>(image.size());
}

TEST(RealLevel, SameBitsForAnyNumberOfThreadsAndOthersForOtherSeeds) {
  SynthOptions options = small_camera(4);
  const auto two = frames_of(options);
  options.threads = 1;
  const auto one = frames_of(options);
  ASSERT_EQ(one.size(), two.size());
  ASSERT_GE(one.size(), 3u);
  for (std::size_t i = 0; i < one.size(); ++i) EXPECT_TRUE(equal_pixels(one[i], two[i]));
  EXPECT_FALSE(equal_pixels(one[0], frames_of(small_camera(1, 2))[0]));
}

TEST(RealLevel, LengthLimitDoesNotChangeTheFrames) {
  const auto few = frames_of(small_camera(3)), more = frames_of(small_camera(6));
  ASSERT_LT(few.size(), more.size());
  for (std::size_t i = 0; i < few.size(); ++i) {
    EXPECT_TRUE(equal_pixels(few[i], more[i]));
    EXPECT_EQ(few[i].timestamp_s, more[i].timestamp_s);
    EXPECT_EQ(few[i].depth_delay_s, more[i].depth_delay_s);
  }
}

TEST(RealLevel, FramesAreThoseRecordedWithoutTheLens) {
  SynthOptions options = small_camera(2);
  const auto frames = frames_of(options);
  options.as_recorded = true;
  const auto recorded = frames_of(options);
  const Undistorter undistorter(options.camera, synth_lens(options));
  ASSERT_EQ(frames.size(), recorded.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_TRUE(equal_images(frames[i].color, undistorter.color(recorded[i].color)));
    EXPECT_TRUE(equal_images(frames[i].depth, undistorter.depth(recorded[i].depth)));
    EXPECT_EQ(share_of(recorded[i].color, [](Rgb8 c) { return c == Rgb8{}; }), 0);
    for (std::size_t k = 0; k < recorded[i].depth.size(); ++k) {
      const double raw = std::round(double{recorded[i].depth.data()[k]} * 5000);
      ASSERT_EQ(recorded[i].depth.data()[k], static_cast<float>(raw / 5000));
    }
  }
}

TEST(RealLevel, WrittenAndReadBackTheyAreTheSame) {
  const io::TemporaryFolder temporary;
  SynthOptions options = small_camera(4);
  const auto frames = frames_of(options);
  options.as_recorded = true;
  dataset::TumSequenceWriter::Options stored;
  stored.distortion = synth_lens(options);
  auto writer = dataset::TumSequenceWriter::create(temporary / "sequence", options.camera, stored);
  ASSERT_TRUE(writer) << writer.error().text();
  for (const RgbdFrame& frame : frames_of(options)) ASSERT_TRUE(writer->add(frame));
  const auto sequence = dataset::open_sequence(temporary / "sequence", {});
  ASSERT_TRUE(sequence) << sequence.error().text();
  RgbdFrame read;
  Error error;
  for (const RgbdFrame& frame : frames) {
    ASSERT_EQ(sequence->frames->next(read, error), dataset::FrameRead::kOk) << error.text();
    EXPECT_TRUE(equal_pixels(read, frame));
    EXPECT_EQ(read.timestamp_s, frame.timestamp_s);
  }
}

TEST(RealLevel, ACushionsRimIsABlackTwentieth) {
  int cushions = 0;
  double rim = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const SynthOptions options = small_camera(1, seed);
    const RgbdFrame frame = frames_of(options).at(0);
    const double black = share_of(frame.color, [](Rgb8 c) { return c == Rgb8{}; });
    if (synth_lens(options).k1 < 0) {
      EXPECT_LT(black, 0.01) << seed;
      continue;
    }
    EXPECT_GT(black, 0.02) << seed;
    EXPECT_LT(black, 0.09) << seed;
    rim += black, ++cushions;
  }
  ASSERT_GT(cushions, 2);
  EXPECT_NEAR(rim / cushions, 0.05, 0.015);
}

TEST(RealLevel, StampsSayTheDelayAndTruthIsThatOfColour) {
  SynthOptions options = small_camera(0);
  const auto source = make_synthetic_source(options);
  const auto motion = handheld_trajectory(options);
  ASSERT_TRUE(source && motion);
  RgbdFrame frame;
  Error error;
  for (int i = 0; i < 3; ++i) {
    ASSERT_EQ((*source)->next(frame, error), dataset::FrameRead::kOk);
    EXPECT_NE(frame.depth_delay_s, 0);
    EXPECT_LE(std::abs(frame.depth_delay_s), 0.02);
    EXPECT_EQ((*source)->ground_truth().poses()[static_cast<std::size_t>(i)].timestamp_s,
              frame.timestamp_s);
    // Stamps are right to a few milliseconds.
    const SE3 off = motion->at(frame.timestamp_s, 0.1)->inverse() * *frame.truth_T_world_camera;
    EXPECT_LT(off.t.norm(), 0.008 * 0.8);
  }
}

TEST(RealLevel, PicturesSaturateAndDepthHasHoles) {
  for (std::uint64_t seed : {1, 2, 3}) {
    const RgbdFrame frame = frames_of(small_camera(1, seed)).at(0);
    const double white = share_of(frame.color, [](Rgb8 c) {
      return std::max({c.r, c.g, c.b}) >= 250;
    });
    EXPECT_GT(white, 0.005) << seed;
    EXPECT_LT(white, 0.3) << seed;
    const double holes = share_of(frame.depth, [](float z) { return z == 0; });
    EXPECT_GT(holes, 0.15) << seed;
    EXPECT_LT(holes, 0.45) << seed;
  }
}

TEST(RealLevel, EachSeedIsAnotherCameraWithinTheRanges) {
  int barrels = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const SensorModel m = SensorModel::of_level("real", seed);
    EXPECT_EQ(m.lens, SensorModel::of_level("real", seed).lens);
    EXPECT_NE(m.lens, SensorModel::of_level("real", seed + 1).lens);
    barrels += m.lens.k1 < 0 ? 1 : 0;
    EXPECT_GE(m.exposure.usual_s, m.exposure.shortest_s);
    EXPECT_LE(m.exposure.usual_s, m.exposure.longest_s);
    EXPECT_LE(std::abs(m.clocks.stamp_late_s), 0.004);
    // The whole picture can be undistorted.
    const PinholeCamera c = SynthOptions{}.camera;
    for (double u : {0.0, c.width - 1.0})
      for (double v : {0.0, c.height - 1.0})
        EXPECT_TRUE(m.lens.invert({(u - c.cx) / c.fx, (v - c.cy) / c.fy})) << seed;
  }
  EXPECT_NEAR(barrels, 40, 20);
}

}  // namespace
}  // namespace sgs::synthetic
