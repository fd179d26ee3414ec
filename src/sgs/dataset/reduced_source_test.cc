// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/reduced_source.h"

#include <gtest/gtest.h>

namespace sgs::dataset {
namespace {

/// One frame of a slope.
class Slope final : public FrameSource {
 public:
  std::string name() const override { return "slope"; }
  PinholeCamera camera() const override { return {64, 48, 50, 50, 31.5, 23.5}; }
  std::optional<std::int64_t> size() const override { return 1; }
  const Trajectory& ground_truth() const override { return truth_; }
  FrameRead next(RgbdFrame& frame, Error&) override {
    if (done_) return FrameRead::kEnd;
    done_ = true;
    frame.camera = camera();
    frame.color = ColorImage(64, 48, {10, 20, 30});
    frame.depth = DepthImage(64, 48);
    for (int v = 0; v < 48; ++v) {
      for (int u = 0; u < 64; ++u) frame.depth(u, v) = 1.0f + static_cast<float>(u);
    }
    return FrameRead::kOk;
  }

 private:
  Trajectory truth_;
  bool done_ = false;
};

TEST(ReducedSource, FramesAndCameraAreReducedTogether) {
  const auto source = reduced(std::make_unique<Slope>(), 32);
  EXPECT_EQ(source->camera(), (PinholeCamera{32, 24, 25, 25, 15.5, 11.5}));
  RgbdFrame frame;
  Error error;
  ASSERT_EQ(source->next(frame, error), FrameRead::kOk);
  EXPECT_EQ(frame.camera, source->camera());
  EXPECT_EQ(frame.color.width(), 32);
  EXPECT_EQ(frame.color(3, 4), (Rgb8{10, 20, 30}));
  EXPECT_EQ(frame.depth.height(), 24);
  // Pixel 10 lies between columns 20 and 21 of the source: one of them, never their mean.
  EXPECT_TRUE(frame.depth(10, 5) == 21.0f || frame.depth(10, 5) == 22.0f) << frame.depth(10, 5);
  EXPECT_EQ(source->next(frame, error), FrameRead::kEnd);
}

TEST(ReducedSource, WhatIsNarrowEnoughIsLeftAlone) {
  auto slope = std::make_unique<Slope>();
  const FrameSource* original = slope.get();
  EXPECT_EQ(reduced(std::move(slope), 64).get(), original);
  EXPECT_EQ(reduced(std::make_unique<Slope>(), 0)->camera().width, 64);
}

}  // namespace
}  // namespace sgs::dataset
