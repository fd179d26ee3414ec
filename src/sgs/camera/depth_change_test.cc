// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/camera/depth_change.h"

#include <gtest/gtest.h>

#include "sgs/core/error.h"

namespace sgs {
namespace {

const PinholeCamera kChangedCamera{64, 48, 60, 60, 31.5, 23.5};

DepthCalibration calibration(double slope, const Eigen::Vector2d& shift_px) {
  DepthCalibration c;
  c.camera = kChangedCamera;
  c.grid = {4, 3};
  for (int k = 0; k < 12; ++k) c.offset_per_m.push_back(slope * (k % 4) - 0.002);
  c.sigma_per_m.assign(12, 1e-4);
  c.shift_px = shift_px;
  return c;
}

/// Inverse depth of a slanted plane as the camera measures it.
double slanted_plane(double u, double v) { return 0.4 + 0.002 * u - 0.001 * v; }

DepthImage measured() {
  DepthImage out(kChangedCamera.width, kChangedCamera.height);
  for (int v = 0; v < out.height(); ++v) {
    for (int u = 0; u < out.width(); ++u) out(u, v) = static_cast<float>(1 / slanted_plane(u, v));
  }
  return out;
}

TEST(DepthChange, OneAfterTheOtherIsTheNewOne) {
  const auto first = calibration(0.001, {0.7, -0.4}), second = calibration(-0.002, {-0.6, 0.9});
  const DepthImage raw = measured();
  const DepthImage changed = DepthChange(first, second).apply(first.apply(raw));
  const DepthImage anew = second.apply(raw);
  for (int v = 4; v < 44; ++v) {
    for (int u = 4; u < 60; ++u) {
      // The offsets are read a shift away, where they differ by some 5e-5 a pixel.
      ASSERT_NEAR(1 / changed(u, v), 1 / anew(u, v), 2.5e-4) << u << " " << v;
    }
  }
}

TEST(DepthChange, FromNothingIsTheCalibrationItself) {
  const auto c = calibration(0.001, {1.2, 0.3});
  const DepthImage raw = measured();
  const DepthImage changed = DepthChange({}, c).apply(raw), anew = c.apply(raw);
  for (std::size_t i = 0; i < raw.size(); ++i) ASSERT_EQ(changed.data()[i], anew.data()[i]);
  const DepthChange back(c, {});
  EXPECT_NEAR(back.shift_px(), std::hypot(1.2, 0.3), 1e-12);
}

// A point on the plane that the camera saw, and the plane's normal towards it.
struct Seen {
  Eigen::Vector3f point, normal;
};
Seen seen(double u, double v, double q, double slope_u, double slope_v) {
  const Eigen::Vector3d ray((u - kChangedCamera.cx) / kChangedCamera.fx,
                            (v - kChangedCamera.cy) / kChangedCamera.fy, 1);
  Eigen::Vector3d n(slope_u * kChangedCamera.fx, slope_v * kChangedCamera.fy, 0);
  n.z() = q - n.x() * ray.x() - n.y() * ray.y();
  return {(ray / q).cast<float>(), (-n.normalized()).cast<float>()};
}

TEST(DepthChange, SurfacePointsFollowTheImage) {
  const auto c = calibration(0.002, {1.1, -0.8});
  const DepthChange change({}, c);
  const DepthImage anew = c.apply(measured());
  for (const auto& [u, v] : {std::pair{10, 12}, {25, 30}, {50, 40}}) {
    Seen s = seen(u, v, slanted_plane(u, v), 0.002, -0.001);
    change.apply(s.point, s.normal);
    EXPECT_NEAR(1 / double{s.point.z()}, 1 / double{anew(u, v)}, 3e-6);
    const auto q = [&](int x, int y) { return 1 / double{anew(x, y)}; };
    const Seen expected = seen(u, v, q(u, v), q(u + 1, v) - q(u, v), q(u, v + 1) - q(u, v));
    EXPECT_GT(s.normal.dot(expected.normal), 0.9999f);

    Eigen::Vector3f point = seen(u, v, slanted_plane(u, v), 0, 0).point;
    change.apply(point, Eigen::Vector2f(0.002f, -0.001f));
    EXPECT_NEAR(1 / double{point.z()}, 1 / double{anew(u, v)}, 3e-6);
  }
}

// A plane n . X = 1 whose depth was measured 10 ms after its colour by a camera that moves.
TEST(DepthChange, WhatWasMeasuredLaterWasSeenFromElsewhere) {
  constexpr double kDelay_s = 0.01;
  Vector6d velocity;
  velocity << 0.3, -0.2, 0.4, 0.5, 0.2, -0.6;
  const SE3 T_colour_depth = SE3::exp(kDelay_s * velocity);
  // Inverse depths are affine over a plane's image: n . (x, y, 1).
  const Eigen::Vector3d n(0.15, -0.1, 0.5);
  const Eigen::Vector3d n_depth = T_colour_depth.R.transpose() * n / (1 - n.dot(T_colour_depth.t));
  const auto q_of = [](const Eigen::Vector3d& plane, double u, double v) {
    return plane.dot(kChangedCamera.back_project(u, v, 1));
  };
  DepthCalibration late;
  late.camera = kChangedCamera;
  late.delay_s = kDelay_s;
  const DepthChange change({}, late);
  EXPECT_EQ(change.delay_s(), kDelay_s);
  for (const auto& [u, v] : {std::pair{10, 12}, {25, 30}, {50, 40}}) {
    const double slope_u = n_depth.x() / kChangedCamera.fx,
                 slope_v = n_depth.y() / kChangedCamera.fy;
    const double q = q_of(n_depth, u, v), before = std::abs(q - q_of(n, u, v));
    EXPECT_GT(before, 5e-4);
    Seen s = seen(u, v, q, slope_u, slope_v);
    const Eigen::Vector3f stays = s.point;
    change.apply(s.point, s.normal, kDelay_s * velocity);
    EXPECT_NEAR(n.dot(s.point.cast<double>()), 1, 0.02 * before / q) << "on the plane";
    EXPECT_GT(std::abs(s.normal.cast<double>().dot(n.normalized())), 1 - 1e-6);
    Eigen::Vector3f on_ray = stays;
    change.apply(on_ray, Eigen::Vector2d(slope_u, slope_v).cast<float>(), kDelay_s * velocity);
    EXPECT_NEAR(1 / double{on_ray.z()}, q_of(n, u, v), 0.02 * before) << "on its ray";
    Eigen::Vector3f point = stays, normal = s.normal;
    change.apply(point, normal);
    EXPECT_LT((point - stays).norm(), 1e-6f) << "a camera that stands still sees the same later";
  }
}

TEST(DepthChange, WhatWouldLieBehindTheCameraStays) {
  const DepthChange change({}, calibration(-0.2, {0, 0}));
  Eigen::Vector3f point(0.2f, 0, 9), normal(0, 0, -1);
  change.apply(point, normal);
  EXPECT_EQ(point.z(), 9);
}

TEST(DepthChange, RmsIsThatOfTheOffsets) {
  DepthCalibration c = calibration(0, {0, 0});
  EXPECT_NEAR(DepthChange({}, c).rms_per_m(), 0.002, 1e-12);
  EXPECT_NEAR(DepthChange(c, c).rms_per_m(), 0, 1e-12);
  EXPECT_EQ(DepthChange({}, {}).rms_per_m(), 0);
}

TEST(DepthChange, GridsMustAgree) {
  DepthCalibration c = calibration(0, {0, 0});
  c.grid = {3, 4};
  EXPECT_THROW(DepthChange(calibration(0, {0, 0}), c), ContractViolation);
}

}  // namespace
}  // namespace sgs
