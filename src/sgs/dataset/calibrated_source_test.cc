// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/calibrated_source.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sgs::dataset {
namespace {

const PinholeCamera kCamera{32, 24, 30, 30, 15.5, 11.5};

/// One frame at two metres, then a bad one, then the end.
class TwoFrames final : public FrameSource {
 public:
  std::string name() const override { return "two frames"; }
  PinholeCamera camera() const override { return kCamera; }
  std::optional<std::int64_t> size() const override { return 2; }
  const Trajectory& ground_truth() const override { return truth_; }
  FrameRead next(RgbdFrame& frame, Error& error) override {
    if (next_ > 1) return FrameRead::kEnd;
    frame.index = next_++;
    if (frame.index == 1) {
      error.message = "damaged";
      return FrameRead::kBadFrame;
    }
    frame.camera = kCamera;
    frame.color = ColorImage(32, 24);
    frame.depth = DepthImage(32, 24, 2.0f);
    return FrameRead::kOk;
  }

 private:
  Trajectory truth_;
  int next_ = 0;
};

DepthCalibration offset_of_a_tenth() {
  DepthCalibration c;
  c.camera = kCamera;
  c.grid = {2, 2};
  c.offset_per_m.assign(4, 0.1);
  c.sigma_per_m.assign(4, 0.01);
  c.delay_s = 0.003;
  return c;
}

TEST(CalibratedSource, CorrectsDepthsAndPassesTheRestOn) {
  auto source = calibrated(std::make_unique<TwoFrames>(), offset_of_a_tenth(), "c.toml");
  ASSERT_TRUE(source);
  EXPECT_EQ((*source)->name(), "two frames");
  EXPECT_EQ((*source)->size(), 2);
  RgbdFrame frame;
  Error error;
  ASSERT_EQ((*source)->next(frame, error), FrameRead::kOk);
  EXPECT_NEAR(frame.depth(16, 12), 1 / 0.6, 1e-5);
  EXPECT_EQ(frame.depth_delay_s, 0.003);
  EXPECT_EQ((*source)->next(frame, error), FrameRead::kBadFrame);
  EXPECT_EQ(error.message, "damaged");
  EXPECT_EQ((*source)->next(frame, error), FrameRead::kEnd);
}

TEST(CalibratedSource, AnotherCamerasCalibrationIsRefused) {
  DepthCalibration c = offset_of_a_tenth();
  c.camera.fx = 40;
  const auto source = calibrated(std::make_unique<TwoFrames>(), c, "c.toml");
  ASSERT_FALSE(source);
  EXPECT_THAT(source.error().message, testing::HasSubstr("c.toml is of another camera"));
  EXPECT_THAT(source.error().message, testing::HasSubstr("f 40.0"));
}

}  // namespace
}  // namespace sgs::dataset
