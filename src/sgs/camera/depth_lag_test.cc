// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/camera/depth_lag.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <vector>

namespace sgs {
namespace {

const PinholeCamera kLagCamera{160, 120, 135, 134, 79.6, 60.3};
constexpr float kBoard_m = 1.2f;

/// Depth of a slanted wall, and of an upright board before it if asked for.
DepthImage depth_from(const SE3& T, bool board) {
  const Eigen::Vector3d normal = Eigen::Vector3d(0.25, -0.15, -1).normalized();
  constexpr double kOffset = -2;
  DepthImage depth(kLagCamera.width, kLagCamera.height);
  for (int v = 0; v < kLagCamera.height; ++v) {
    for (int u = 0; u < kLagCamera.width; ++u) {
      const Eigen::Vector3d ray = T.R * kLagCamera.back_project(u, v, 1);
      double z = (kOffset - normal.dot(T.t)) / normal.dot(ray);
      const double at = (double{kBoard_m} - T.t.z()) / ray.z();
      const Eigen::Vector3d hit = T.t + at * ray;
      if (board && std::abs(hit.x()) < 0.25 && std::abs(hit.y()) < 0.2) z = at;
      depth(u, v) = static_cast<float>(z);
    }
  }
  return depth;
}

Vector6d twist_of(double rx, double ry, double rz, double x, double y, double z) {
  Vector6d xi;
  xi << rx, ry, rz, x, y, z;
  return xi;
}

/// As much as a hand moves a camera in half a frame, in all directions and in each.
std::vector<Vector6d> lags() {
  std::vector<Vector6d> out = {twist_of(0.012, -0.015, 0.01, 0.01, -0.008, 0.012)};
  for (int k = 0; k < 6; ++k) out.emplace_back(0.015 * Vector6d::Unit(k));
  for (int k = 0; k < 6; ++k) out.emplace_back(-0.015 * Vector6d::Unit(k));
  return out;
}

TEST(DepthLag, DepthIsThatOfTheColoursPose) {
  for (const Vector6d& lag : lags()) {
    const DepthImage want = depth_from(SE3{}, false);
    const DepthImage measured = depth_from(SE3::exp(lag), false);
    const DepthImage got = depth_with_colour(measured, kLagCamera, lag);
    double worst = 0, uncorrected = 0;
    int missing = 0;
    for (int v = 0; v < kLagCamera.height; ++v) {
      for (int u = 0; u < kLagCamera.width; ++u) {
        uncorrected = std::max(uncorrected, double{std::abs(measured(u, v) - want(u, v))});
        missing += got(u, v) == 0;
        if (got(u, v) > 0) worst = std::max(worst, double{std::abs(got(u, v) - want(u, v))});
      }
    }
    // Neighbouring pixels of the wall differ by up to 8 mm, and half of it is lost by taking the
    // nearest; the border that only one of both poses saw is missing.
    EXPECT_LT(worst, 0.007) << lag.transpose();
    EXPECT_LT(missing, 0.04 * static_cast<double>(want.size())) << lag.transpose();
    if (lag == lags().front()) {
      EXPECT_GT(uncorrected, 3 * worst);
    }
  }
}

TEST(DepthLag, EdgesMoveWithTheirSurfaceAndNothingIsMixed) {
  const Vector6d lag = twist_of(0, 0, 0, 0.03, 0, 0);  // 3 pixels of parallax at the board
  const DepthImage want = depth_from(SE3{}, true), measured = depth_from(SE3::exp(lag), true);
  const DepthImage got = depth_with_colour(measured, kLagCamera, lag);
  const std::set<float> values(measured.data(), measured.data() + measured.size());
  int wrong = 0, wrong_before = 0;
  for (int v = 0; v < kLagCamera.height; ++v) {
    for (int u = 8; u < kLagCamera.width - 8; ++u) {
      EXPECT_TRUE(got(u, v) == 0 || values.contains(got(u, v)));
      wrong += got(u, v) > 0 && std::abs(got(u, v) - want(u, v)) > 0.05f;
      wrong_before += std::abs(measured(u, v) - want(u, v)) > 0.05f;
    }
  }
  EXPECT_GT(wrong_before, 200);
  EXPECT_LT(wrong, wrong_before / 2);  // what the board hid is not known
}

TEST(DepthLag, HolesStayHolesAndMoveAlong) {
  DepthImage measured(kLagCamera.width, kLagCamera.height, kBoard_m);
  for (int v = 50; v < 70; ++v) std::fill_n(measured.row(v) + 70, 20, 0.0f);
  // The camera went 5 pixels to the right, so what it sees went left.
  const double move = 5 * double{kBoard_m} / kLagCamera.fx;
  const DepthImage got = depth_with_colour(measured, kLagCamera, twist_of(0, 0, 0, move, 0, 0));
  EXPECT_EQ(got(74, 60), kBoard_m);
  EXPECT_EQ(got(75, 60), 0);
  EXPECT_EQ(got(94, 60), 0);
  EXPECT_EQ(got(95, 60), kBoard_m);
  EXPECT_EQ(got(2, 60), 0);  // came from outside the picture
}

TEST(DepthLag, NothingChangesWithoutLagOrDepth) {
  const DepthImage depth = depth_from(SE3{}, true);
  const DepthImage same = depth_with_colour(depth, kLagCamera, Vector6d::Zero());
  EXPECT_TRUE(std::equal(depth.data(), depth.data() + depth.size(), same.data()));
  const DepthImage empty = depth_with_colour(DepthImage(kLagCamera.width, kLagCamera.height, 0.0f),
                                             kLagCamera, Vector6d::Constant(0.01));
  EXPECT_EQ(std::count(empty.data(), empty.data() + empty.size(), 0.0f),
            static_cast<std::ptrdiff_t>(empty.size()));
}

TEST(DepthLag, FrameOfOneTimeLagsNoLonger) {
  const Vector6d lag = lags().front();
  RgbdFrame lagging;
  lagging.index = 7;
  lagging.timestamp_s = 3;
  lagging.camera = kLagCamera;
  lagging.color = ColorImage(kLagCamera.width, kLagCamera.height);
  lagging.depth = depth_from(SE3::exp(lag), true);
  lagging.depth_delay_s = 0.02;
  const auto frame = std::make_shared<const RgbdFrame>(lagging);
  EXPECT_EQ(frame_of_one_time(frame, Vector6d::Zero()), frame);

  const auto one_time = frame_of_one_time(frame, lag);
  EXPECT_EQ(one_time->depth_delay_s, 0);
  EXPECT_EQ(one_time->index, 7);
  EXPECT_EQ(one_time->timestamp_s, 3);
  const DepthImage want = depth_with_colour(lagging.depth, kLagCamera, lag);
  EXPECT_TRUE(std::equal(want.data(), want.data() + want.size(), one_time->depth.data()));
  EXPECT_EQ(frame->depth_delay_s, 0.02);
}

}  // namespace
}  // namespace sgs
