// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/backend/sure_calibration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sgs/backend/test_room.h"

namespace sgs::backend {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr int kViewsOfBoth = 24;

CalibrationConfig coarse_config() {
  CalibrationConfig config;
  config.columns = 8;
  config.rows = 6;
  return config;
}

/// Views of two cameras, one after the other: whatever they lie about changes in the middle.
std::vector<Keyframe> keyframes_of(const TestRoom& first, const TestRoom& second) {
  std::vector<Keyframe> out = first.keyframes(kViewsOfBoth);
  std::vector<Keyframe> later = second.keyframes(kViewsOfBoth);
  for (std::size_t k = kViewsOfBoth / 2; k < out.size(); ++k) out[k] = std::move(later[k]);
  return out;
}

DepthEstimate both_say(const TestRoom& first, const TestRoom& second) {
  return calibrate_surely(keyframes_of(first, second), TestRoom::tracked_path(kViewsOfBoth), 0,
                          coarse_config());
}

TEST(SureCalibration, ARecordingThatAgreesIsBelieved) {
  TestRoom room;
  room.distort = [](double, double, double q) { return q - 0.006; };
  room.shift_px = {1.4, -0.8};
  room.delay_s = 0.002;
  const DepthEstimate e = both_say(room, room);
  EXPECT_THAT(e.refused, IsEmpty());
  EXPECT_FALSE(e.contradicted.any()) << e.contradicted.names();
  EXPECT_TRUE(e.known.mean && e.known.shift && e.known.delay);
  EXPECT_NEAR(e.calibration.mean_offset_per_m(), 0.006, 6e-4);
  EXPECT_NEAR(e.calibration.delay_s, 0.002, 4e-4);
}

TEST(SureCalibration, ACameraThatIsRightStaysAsItIs) {
  const DepthEstimate e = both_say({}, {});
  EXPECT_FALSE(e.useful());
  EXPECT_THAT(e.refused, IsEmpty());
}

TEST(SureCalibration, ADelayThatDriftsIsNotUsed) {
  TestRoom early, late;
  early.delay_s = 0.001;
  late.delay_s = 0.009;
  const DepthEstimate e = both_say(early, late);
  EXPECT_TRUE(e.contradicted.delay);
  EXPECT_EQ(e.calibration.delay_s, 0);
  EXPECT_GT(e.calibration.delay_sigma_s, 0.002);  // who says nothing does not say that it is sure
}

TEST(SureCalibration, WhatIsSaidDifferentlyIsRefusedAndNamed) {
  TestRoom early, late;
  early.shift_px = {2, 0};
  late.shift_px = {-2, 1.5};
  const DepthEstimate e = both_say(early, late);
  EXPECT_TRUE(e.contradicted.shift);
  EXPECT_TRUE(e.calibration.shift_px.isZero());
  EXPECT_GT(e.calibration.shift_sigma_px.x(), 1);
}

TEST(SureCalibration, TooFewKeyframesStillSaySo) {
  EXPECT_THAT(
      calibrate_surely(TestRoom().keyframes(5), TestRoom::tracked_path(5), 0, coarse_config())
          .why_not,
      HasSubstr("5 keyframes"));
}

}  // namespace
}  // namespace sgs::backend
