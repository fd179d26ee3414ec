// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/history/revision.h"

#include <gtest/gtest.h>

namespace sgs::history {
namespace {

SE3 beside(double x) { return {Eigen::Matrix3d::Identity(), {x, 0, 0}}; }

CalibrationPtr calibration(double offset_per_m) {
  DepthCalibration c;
  c.camera = {64, 48, 60, 60, 31.5, 23.5};
  c.grid = {2, 2};
  c.offset_per_m.assign(4, offset_per_m);
  c.delay_s = offset_per_m;
  return std::make_shared<const DepthCalibration>(std::move(c));
}

TEST(Revision, CountsWhatItCameFrom) {
  Revision first;
  first.path.append({0, 0, beside(0)});
  const Revision closed = revised(first, {PoseCorrection({{0, beside(0), beside(2)}})});
  EXPECT_EQ(closed.loops, 1);
  EXPECT_EQ(closed.number(), 1);
  EXPECT_EQ(closed.calibration, nullptr);
  EXPECT_EQ(closed.path.at(0).t.x(), 2);
  EXPECT_EQ(first.path.at(0).t.x(), 0);
  const Revision calibrated = revised(closed, {{}, calibration(0.002)});
  EXPECT_EQ(calibrated.loops, 1);
  EXPECT_EQ(calibrated.calibrations, 1);
  EXPECT_EQ(calibrated.number(), 2);
  EXPECT_EQ(calibrated.path.at(0).t.x(), 2);
  const Revision again = revised(calibrated, {PoseCorrection({{0, beside(2), beside(3)}})});
  EXPECT_EQ(again.calibration, calibrated.calibration);
  const Revision seen =
      revised(again, {.poses = PoseCorrection({{0, beside(3), beside(4)}}), .tracked_anew = true});
  EXPECT_EQ(seen.second_looks, 1);
  EXPECT_EQ(seen.loops, again.loops);
  EXPECT_EQ(seen.number(), again.number() + 1);
  EXPECT_EQ(seen.path.at(0).t.x(), 4);
}

TEST(Revision, DepthChangesFromOneCalibrationToTheNext) {
  const auto one = calibration(0.001), two = calibration(0.004);
  EXPECT_EQ(depth_change(one, one), nullptr);
  EXPECT_EQ(depth_change(nullptr, nullptr), nullptr);
  EXPECT_NEAR(depth_change(nullptr, one)->delay_s(), 0.001, 1e-12);
  EXPECT_NEAR(depth_change(one, two)->rms_per_m(), 0.003, 1e-9);
  EXPECT_TRUE(depth_change(one, two)->after() == *two);
  EXPECT_NEAR(depth_change(two, nullptr)->delay_s(), -0.004, 1e-12);
}

}  // namespace
}  // namespace sgs::history
