// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/camera/depth_calibration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sgs/core/error.h"

namespace sgs {
namespace {

const PinholeCamera kCalibratedCamera{64, 48, 60, 60, 31.5, 23.5};

DepthCalibration constant_offset(double offset_per_m) {
  DepthCalibration c;
  c.camera = kCalibratedCamera;
  c.grid = {4, 3};
  c.offset_per_m.assign(12, offset_per_m);
  c.sigma_per_m.assign(12, 1e-4);
  return c;
}

/// Inverse depth of a slanted plane.
double plane(double u, double v) { return 0.4 + 0.002 * u - 0.001 * v; }

TEST(ImageGrid, WeightsAddUpAndReachTheCorners) {
  const ImageGrid grid{4, 3};
  for (const auto& [u, v] : {std::pair{0.0, 0.0}, {63.0, 47.0}, {20.3, 11.8}, {-5.0, 99.0}}) {
    const GridWeights w = grid.at(u, v, kCalibratedCamera);
    EXPECT_NEAR(std::accumulate(w.weight.begin(), w.weight.end(), 0.0), 1, 1e-12);
    for (const int node : w.node) EXPECT_TRUE(node >= 0 && node < 12);
  }
  EXPECT_EQ(grid.at(0, 0, kCalibratedCamera).weight[0], 1);
  EXPECT_EQ(grid.at(63, 47, kCalibratedCamera).weight[3], 1);
  EXPECT_EQ(grid.at(63, 47, kCalibratedCamera).node[3], 11);
  const auto area = grid.area();
  EXPECT_NEAR(std::accumulate(area.begin(), area.end(), 0.0), 1, 1e-12);
}

TEST(DepthCalibration, OneNodeHoldsForTheWholeImage) {
  DepthCalibration c = constant_offset(0.01);
  c.grid = {1, 1};
  c.offset_per_m = {0.01};
  EXPECT_NEAR(c.offset_at(40, 7), 0.01, 1e-12);
  EXPECT_NEAR(c.mean_offset_per_m(), 0.01, 1e-12);
}

TEST(DepthCalibration, UndoesWhatTheModelDoes) {
  DepthCalibration c = constant_offset(0);
  for (std::size_t k = 0; k < 12; ++k) c.offset_per_m[k] = 0.001 * static_cast<double>(k) - 0.004;
  c.shift_px = {1.3, -0.6};
  DepthImage measured(64, 48);
  for (int v = 0; v < 48; ++v) {
    for (int u = 0; u < 64; ++u) {
      const double q = plane(u + c.shift_px.x(), v + c.shift_px.y()) - c.offset_at(u, v);
      measured(u, v) = static_cast<float>(1 / q);
    }
  }
  const DepthImage ideal = c.apply(measured);
  for (int v = 2; v < 46; ++v) {
    for (int u = 2; u < 62; ++u) ASSERT_NEAR(1 / ideal(u, v), plane(u, v), 2e-6) << u << " " << v;
  }
}

TEST(DepthCalibration, NothingIsInventedAndSurfacesAreNotMixed) {
  DepthCalibration c = constant_offset(0.002);
  c.shift_px = {0.5, 0};
  DepthImage measured(64, 48, 1.0f);
  for (int v = 0; v < 48; ++v) {
    for (int u = 32; u < 64; ++u) measured(u, v) = u < 40 ? 0.0f : 3.0f;
  }
  const DepthImage out = c.apply(measured);
  const float near = 1 / 1.002f, far = 1 / (1 / 3.0f + 0.002f);
  for (int u = 1; u < 64; ++u) {
    const float z = out(u, 20);
    EXPECT_TRUE(z == 0 || std::abs(z - near) < 1e-5f || std::abs(z - far) < 1e-4f)
        << u << ": " << z;
  }
  EXPECT_EQ(out(36, 20), 0);
}

TEST(DepthCalibration, AnOffsetBeyondInfinityIsNoMeasurement) {
  const DepthCalibration c = constant_offset(-0.2);
  const DepthImage out = c.apply(DepthImage(64, 48, 5.0f));
  EXPECT_EQ(out(10, 10), 0);
}

TEST(DepthCalibration, NothingToCorrectLeavesTheBits) {
  DepthImage measured(64, 48);
  for (std::size_t i = 0; i < measured.size(); ++i) {
    measured.data()[i] = 0.3f + 0.0017f * static_cast<float>(i);
  }
  const DepthImage out = constant_offset(0).apply(measured);
  EXPECT_TRUE(std::equal(out.data(), out.data() + out.size(), measured.data()));
  EXPECT_TRUE(constant_offset(0).corrects_nothing());
  EXPECT_FALSE(constant_offset(1e-9).corrects_nothing());
}

TEST(DepthCalibration, WholePixelsOnlyMove) {
  DepthCalibration c = constant_offset(0);
  c.shift_px = {2, 0};
  DepthImage measured(64, 48);
  measured(10, 10) = 2;
  const DepthImage out = c.apply(measured);
  EXPECT_FLOAT_EQ(out(12, 10), 2);
  EXPECT_EQ(out(10, 10), 0);
}

TEST(DepthCalibration, AnotherSizeIsAnError) {
  EXPECT_THROW(constant_offset(0).apply(DepthImage(32, 48)), ContractViolation);
}

}  // namespace
}  // namespace sgs
