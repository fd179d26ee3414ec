// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/backend/calibrate_depth.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sgs/backend/test_room.h"

namespace sgs::backend {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr int kViews = 24;

/// A coarse grid suits a small image.
CalibrationConfig small_config() {
  CalibrationConfig config;
  config.columns = 8;
  config.rows = 6;
  return config;
}

DepthEstimate calibrated(const TestRoom& room, int views = kViews) {
  return calibrate_depth(room.keyframes(views), TestRoom::tracked_path(views), 0, small_config());
}

TEST(CalibrateDepth, ACameraThatIsRightStaysAsItIs) {
  const DepthEstimate e = calibrated({});
  EXPECT_THAT(e.why_not, IsEmpty());
  EXPECT_FALSE(e.useful());
  EXPECT_TRUE(e.calibration.shift_px.isZero());
  EXPECT_EQ(e.calibration.delay_s, 0);
  for (const double offset : e.calibration.offset_per_m) EXPECT_EQ(offset, 0);
  EXPECT_THAT(e.warnings(), IsEmpty());
}

TEST(CalibrateDepth, AFactorCommonToAllDepthsCannotBeKnownAndIsLeftAlone) {
  TestRoom room;
  room.distort = [](double, double, double q) { return q / 1.01; };
  const DepthEstimate e = calibrated(room);
  EXPECT_THAT(e.why_not, IsEmpty());
  EXPECT_LT(std::abs(e.calibration.mean_offset_per_m()),
            std::max(2 * e.calibration.mean_sigma_per_m, 3e-4));
}

TEST(CalibrateDepth, FindsAnOffsetOfDisparity) {
  TestRoom room;
  room.distort = [](double, double, double q) { return q - 0.006; };
  const DepthEstimate e = calibrated(room);
  EXPECT_TRUE(e.known.mean);
  EXPECT_NEAR(e.calibration.mean_offset_per_m(), 0.006, 5e-4);
}

TEST(CalibrateDepth, FindsAShapeOverTheImage) {
  TestRoom room;
  const auto truth = [](double u, double v) {
    return 0.004 + 0.003 * std::sin(u / 50) * std::cos(v / 60);
  };
  room.distort = [&](double u, double v, double q) { return q - truth(u, v); };
  const DepthEstimate e = calibrated(room);
  EXPECT_TRUE(e.known.shape && e.known.mean);
  for (const auto& [u, v] : {std::pair{40.0, 60.0}, {160.0, 120.0}, {270.0, 60.0}, {80.0, 190.0}}) {
    EXPECT_NEAR(e.calibration.offset_at(u, v), truth(u, v), 1e-3) << u << " " << v;
  }
}

TEST(CalibrateDepth, FindsAShiftOfDepthAgainstColour) {
  TestRoom room;
  room.shift_px = {1.4, -0.8};
  const DepthEstimate e = calibrated(room);
  EXPECT_TRUE(e.known.shift);
  EXPECT_NEAR(e.calibration.shift_px.x(), 1.4, 0.2);
  EXPECT_NEAR(e.calibration.shift_px.y(), -0.8, 0.2);
}

TEST(CalibrateDepth, FindsADelayOfDepthAfterColour) {
  TestRoom room;
  room.delay_s = 0.002;
  const DepthEstimate e = calibrated(room);
  EXPECT_TRUE(e.known.delay);
  EXPECT_NEAR(e.calibration.delay_s, 0.002, 3e-4);
  EXPECT_LT(e.calibration.delay_sigma_s, 5e-4);
}

/// RMS error of inverse depth in views that took no part, but for the common factor that fits best.
double error_of(const TestRoom& room, const DepthCalibration& calibration) {
  double squares = 0, along = 0, truth_squares = 0;
  int n = 0;
  for (const int k : {30, 41, 55}) {
    const DepthImage truth = TestRoom().view(k)->depth;
    const DepthImage depth = calibration.apply(room.view(k)->depth);
    for (int v = 4; v < depth.height() - 4; v += 3) {
      for (int u = 4; u < depth.width() - 4; u += 3) {
        if (depth(u, v) <= 0) continue;
        const double q = 1 / double{truth(u, v)}, off = 1 / double{depth(u, v)} - q;
        squares += off * off;
        along += off * q;
        truth_squares += q * q;
        ++n;
      }
    }
  }
  return std::sqrt((squares - along * along / truth_squares) / n);
}

TEST(CalibrateDepth, SensorsThatErrInOtherWaysGetBetter) {
  const auto radius2 = [](double u, double v) {
    const double x = (u - 159.5) / 160, y = (v - 119.5) / 160;
    return x * x + y * y - 0.52;
  };
  const std::vector<std::pair<const char*, TestRoom::Distortion>> sensors = {
      {"a factor over the image",
       [&](double u, double v, double q) { return q / (1 + 0.02 * radius2(u, v)); }},
      {"that and an offset",
       [&](double u, double v, double q) { return q / (1 + 0.02 * radius2(u, v)) - 0.004; }},
      {"a factor that tilts", [](double u, double, double q) { return q + 6e-5 * (u - 160) * q; }},
      {"errors that grow with depth",
       [](double, double, double q) { return q - 0.004 + 0.003 * q * q; }},
      {"that over the image",
       [&](double u, double v, double q) { return q - 0.002 * radius2(u, v) / q; }}};
  for (const auto& [name, distort] : sensors) {
    TestRoom room;
    room.distort = distort;
    const DepthCalibration found = calibrated(room).calibration;
    DepthCalibration none = found;
    none.offset_per_m.assign(none.offset_per_m.size(), 0);
    none.shift_px.setZero();
    EXPECT_LT(error_of(room, found), error_of(room, none) / 1.6) << name;
  }
}

TEST(CalibrateDepth, AWrongRegistrationIsNamed) {
  TestRoom room;
  room.shift_px = {6, 0};
  const DepthEstimate e = calibrated(room);
  ASSERT_EQ(e.warnings().size(), 1u);
  EXPECT_THAT(e.warnings().front(), HasSubstr("registration"));
}

TEST(CalibrateDepth, ALateImageIsSuspiciousWhereNobodyElseSeesIt) {
  DepthEstimate e;
  e.calibration.delay_s = -0.017;
  EXPECT_TRUE(e.is_delay_suspicious());
  e.tracked_delay_s = -0.001;
  EXPECT_TRUE(e.is_delay_suspicious()) << "the tracker sees another";
  e.tracked_delay_s = -0.0155;
  EXPECT_FALSE(e.is_delay_suspicious()) << "the tracker sees it, too";
  e.tracked_delay_s.reset();
  e.stamped = true;
  EXPECT_FALSE(e.is_delay_suspicious()) << "both images have stamps: they say when each came";
  e.calibration.delay_s = 0.05;
  EXPECT_TRUE(e.is_delay_suspicious()) << "more than a frame";
  e.stamped = false;
  e.calibration.delay_s = 0.004;
  EXPECT_FALSE(e.is_delay_suspicious());
}

TEST(CalibrateDepth, WhatIsHeldStaysNothing) {
  TestRoom room;
  room.distort = [](double, double, double q) { return q - 0.006; };
  room.shift_px = {1.4, -0.8};
  const auto views = room.keyframes(kViews);
  const DepthEstimate e =
      calibrate_depth(useful_keyframes(views, TestRoom::tracked_path(kViews)), 0, small_config(),
                      {.shape = true, .shift = true, .delay = true});
  EXPECT_EQ(e.known.names(), "mean offset");
  EXPECT_TRUE(e.calibration.shift_px.isZero());
  EXPECT_EQ(e.calibration.delay_s, 0);
  for (const double offset : e.calibration.offset_per_m) {
    EXPECT_NEAR(offset, e.calibration.mean_offset_per_m(), 1e-9);
  }
}

TEST(CalibrateDepth, WithoutContrastNothingIsSaid) {
  TestRoom room;
  room.contrast = 0;
  const DepthEstimate e = calibrated(room, 10);
  EXPECT_THAT(e.why_not, HasSubstr("contrast"));
  EXPECT_FALSE(e.useful());
}

TEST(CalibrateDepth, AFewKeyframesAreTooFew) {
  EXPECT_THAT(calibrated({}, 5).why_not, HasSubstr("5 keyframes"));
}

TEST(CalibrateDepth, TheSameBitsTwice) {
  TestRoom room;
  room.distort = [](double, double, double q) { return q - 0.006; };
  const DepthEstimate a = calibrated(room, 12), b = calibrated(room, 12);
  EXPECT_EQ(a.calibration, b.calibration);
}

}  // namespace
}  // namespace sgs::backend
