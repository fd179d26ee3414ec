// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/camera/register_depth.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

namespace sgs {
namespace {

const PinholeCamera kPinhole{160, 120, 131.3, 130.1, 79.2, 60.7};
const Distortion kLens{0.2624, -0.9531, -0.0054, 0.0026, 1.1633};

/// Depth of the ray (x, y, 1) through the camera, along its axis; 0 = none.
using World = std::function<double(double x, double y)>;

DepthImage look_at(const PinholeCamera& k, const World& world) {
  DepthImage depth(k.width, k.height);
  for (int v = 0; v < k.height; ++v) {
    for (int u = 0; u < k.width; ++u) {
      depth(u, v) = static_cast<float>(world((u - k.cx) / k.fx, (v - k.cy) / k.fy));
    }
  }
  return depth;
}

/// The plane n.p = d.
World plane(const Eigen::Vector3d& n, double d) {
  return [=](double x, double y) { return d / n.dot(Eigen::Vector3d(x, y, 1)); };
}

SE3 moved(double x, double y, double z) { return {Eigen::Matrix3d::Identity(), {x, y, z}}; }

/// The plane as seen after p' = T p.
World plane_after(const SE3& T, const Eigen::Vector3d& n, double d) {
  const Eigen::Vector3d turned = T.R * n;
  return plane(turned, d + turned.dot(T.t));
}

/// Measured depths of no smoothness at all, with holes.
DepthImage rough_depth(const PinholeCamera& k) {
  DepthImage depth(k.width, k.height);
  std::uint32_t state = 12345;
  for (std::size_t i = 0; i < depth.size(); ++i) {
    state = state * 1664525u + 1013904223u;
    const double unit = (state >> 8) / 16777216.0;
    depth.data()[i] = unit < 0.2 ? 0.0f : static_cast<float>(0.3 + 7 * unit);
  }
  return depth;
}

TEST(DepthRegistration, IdentityOfEqualCamerasIsTheInputBitForBit) {
  const DepthImage depth = rough_depth(kPinhole);
  for (const Distortion& lens : {Distortion{}, kLens}) {
    const DepthRegistration same({kPinhole, lens}, {kPinhole, lens}, SE3{});
    const DepthImage out = same(depth);
    for (std::size_t i = 0; i < depth.size(); ++i) ASSERT_EQ(out.data()[i], depth.data()[i]) << i;
  }
}

// A plane stays a plane: no holes, and each value within what half a pixel of it can change.
TEST(DepthRegistration, SlantedPlaneStaysClosedWhereBothCamerasSeeIt) {
  const Eigen::Vector3d n = Eigen::Vector3d(0.8, 0.2, 1).normalized();
  const SE3 T(so3_exp({0.02, -0.03, 0.05}), {0.05, -0.01, 0.02});
  for (const double fine : {1.0, 3.0, 0.5}) {
    const PinholeCamera color{static_cast<int>(160 * fine),
                              static_cast<int>(120 * fine),
                              140 * fine,
                              140 * fine,
                              80 * fine,
                              60 * fine};
    const DepthRegistration registration({kPinhole, {}}, {color, {}}, T);
    const DepthImage out = registration(look_at(kPinhole, plane(n, 1.5)));
    const World truth = plane_after(T, n, 1.5);
    int seen = 0;
    for (int v = 0; v < color.height; ++v) {
      for (int u = 0; u < color.width; ++u) {
        const double x = (u - color.cx) / color.fx, y = (v - color.cy) / color.fy;
        const double z = truth(x, y);
        const Eigen::Vector3d source = T.inverse() * Eigen::Vector3d(x * z, y * z, z);
        const Eigen::Vector2d pixel = kPinhole.project(source);
        if (pixel.minCoeff() < 0 || pixel.x() > 159 || pixel.y() > 119) continue;
        ++seen;
        ASSERT_GT(out(u, v), 0) << "hole at " << u << " " << v << " of " << fine;
        // A measurement stands for its pixel: 0.71 px to its corner, and turned patches overlap.
        const double slope =
            std::max(std::abs(truth(x + 1.0 / 131, y) - z), std::abs(truth(x, y + 1.0 / 131) - z));
        ASSERT_NEAR(out(u, v), z, 1.3 * slope + 1e-5) << u << " " << v << " of " << fine;
      }
    }
    EXPECT_GT(seen, color.width * color.height / 2);
  }
}

// A square 0.5 m before a wall. From 5 cm aside each pixel must show the one or the other, never a
// depth between; the square hides the wall behind it, and the strip that the depth camera could not
// see stays empty.
TEST(DepthRegistration, EdgesStayEdgesAndTheNearerSurfaceHides) {
  constexpr double kNear = 1.0, kFar = 1.5, kHalf = 0.2, kAside = 0.05;
  const auto scene = [&](double shift) {
    return [=](double x, double y) {
      const bool on = std::abs(x * kNear - shift) <= kHalf && std::abs(y * kNear) <= kHalf;
      return on ? kNear : kFar;
    };
  };
  for (const int fine : {1, 3}) {
    const PinholeCamera color{160 * fine,   120 * fine,  130.0 * fine,
                              130.0 * fine, 79.5 * fine, 59.5 * fine};
    const PinholeCamera depth{160, 120, 130, 130, 79.5, 59.5};
    const DepthRegistration registration({depth, {}}, {color, {}}, moved(kAside, 0, 0));
    const DepthImage out = registration(look_at(depth, scene(0)));
    const DepthImage truth = look_at(color, scene(kAside));
    int wrong = 0, empty = 0, near = 0;
    for (int v = 0; v < color.height; ++v) {
      for (int u = 12 * fine; u < color.width; ++u) {
        const float z = out(u, v);
        ASSERT_TRUE(z == 0 || z == static_cast<float>(kNear) || z == static_cast<float>(kFar));
        near += truth(u, v) == static_cast<float>(kNear);
        empty += z == 0;
        wrong += z != 0 && z != truth(u, v);
      }
    }
    ASSERT_GT(near, 1000);
    // The border of the square is known to a pixel of the depth camera.
    EXPECT_LE(wrong, 4 * 53 * fine * fine);
    // The strip: 130 px/m * 0.05 m * (1/1 - 1/1.5) = 2.2 px wide beside 53 rows.
    EXPECT_GT(empty, 53 * fine * fine);
    EXPECT_LT(empty, 4 * 53 * fine * fine);
  }
}

// The nearer of two measurements on one pixel counts, in whichever order they come.
TEST(DepthRegistration, NearestOfSeveralMeasurementsCounts) {
  const PinholeCamera coarse{20, 15, 16.4, 16.3, 9.5, 7.2};
  for (const bool near_first : {false, true}) {
    const auto half = [=](double x, double) { return (x < 0) == near_first ? 1.0 : 3.0; };
    // From far aside, both halves fall on the same pixels.
    const DepthRegistration registration({kPinhole, {}}, {coarse, {}},
                                         moved(near_first ? 0.5 : -0.5, 0, 0));
    const DepthImage out = registration(look_at(kPinhole, half));
    const int u = near_first ? 12 : 7;
    EXPECT_EQ(out(u, 7), 1.0f);
  }
}

// With the lenses known, a wall is flat in the undistorted picture and in the distorted one, up to
// the border.
TEST(DepthRegistration, LensesOfBothCamerasAreTakenIntoAccount) {
  const Distortion rational{0.5, -2.6, 0.0003, -0.0002, 1.5, 0.38, -2.4, 1.43};
  const World wall = plane(Eigen::Vector3d(0.3, 0, 1).normalized(), 2);
  const LensCamera source{kPinhole, kLens};
  DepthImage measured(kPinhole.width, kPinhole.height);
  for (int v = 0; v < kPinhole.height; ++v) {
    for (int u = 0; u < kPinhole.width; ++u) {
      const auto xy = kLens.invert(kPinhole.back_project(u, v, 1).head<2>());
      if (xy) measured(u, v) = static_cast<float>(wall(xy->x(), xy->y()));
    }
  }
  for (const Distortion& lens : {Distortion{}, rational}) {
    const DepthRegistration registration(source, {kPinhole, lens}, SE3{});
    const DepthImage out = registration(measured);
    int compared = 0;
    for (int v = 15; v < 105; ++v) {
      for (int u = 15; u < 145; ++u) {
        const auto xy = lens.invert(kPinhole.back_project(u, v, 1).head<2>());
        ASSERT_TRUE(xy);
        const double z = wall(xy->x(), xy->y());
        const double step = std::abs(wall(xy->x() + 1 / kPinhole.fx, xy->y()) - z);
        ASSERT_NEAR(out(u, v), z, step) << u << " " << v;
        ++compared;
      }
    }
    EXPECT_EQ(compared, 90 * 130);
  }
}

// Points at and behind the colour camera, and without bounds there, draw nothing and cost nothing.
TEST(DepthRegistration, PointsBehindTheColourCameraAreLeftOut) {
  const DepthImage near = look_at(kPinhole, [](double, double) { return 1.0; });
  for (const double z : {-1.0, -1.5, -0.9999}) {
    const DepthImage out = DepthRegistration({kPinhole, {}}, {kPinhole, {}}, moved(0, 0, z))(near);
    for (std::size_t i = 0; i < out.size(); ++i) ASSERT_EQ(out.data()[i], 0) << z;
  }
}

TEST(DepthRegistration, RefusesSizesAndTransformsThatDoNotFit) {
  const DepthRegistration registration({kPinhole, {}}, {kPinhole, {}}, SE3{});
  EXPECT_THROW(registration(DepthImage(3, 3)), ContractViolation);
  const SE3 nan = moved(std::numeric_limits<double>::quiet_NaN(), 0, 0);
  EXPECT_THROW(DepthRegistration({kPinhole, {}}, {kPinhole, {}}, nan), ContractViolation);
  EXPECT_THROW(DepthRegistration({}, {kPinhole, {}}, SE3{}), ContractViolation);
}

TEST(Distortion, InvertUndoesApplyAndRefusesWhatFoldsBack) {
  const Distortion rational{0.5, -2.6, 0.0003, -0.0002, 1.5, 0.38, -2.4, 1.43};
  for (const Distortion& lens : {Distortion{}, kLens, rational}) {
    for (double x = -0.5; x <= 0.5; x += 0.125) {
      for (double y = -0.4; y <= 0.4; y += 0.1) {
        const auto back = lens.invert(lens.apply({x, y}));
        ASSERT_TRUE(back) << x << " " << y;
        EXPECT_LT((*back - Eigen::Vector2d(x, y)).norm(), 1e-10);
      }
    }
  }
  // r (1 - r^2 / 2) has its largest value, 0.544, at r = 0.816: nothing is seen beyond it.
  const Distortion folding{-0.5, 0, 0, 0, 0};
  EXPECT_TRUE(folding.invert({0.54, 0}));
  EXPECT_FALSE(folding.invert({0.55, 0}));
}

TEST(Distortion, RationalDenominatorDivides) {
  const Eigen::Vector2d xy(0.3, -0.2);
  const double r2 = 0.13;
  const Distortion d{1, 2, 0, 0, 3, 4, 5, 6};
  const double radial =
      (1 + r2 + 2 * r2 * r2 + 3 * r2 * r2 * r2) / (1 + 4 * r2 + 5 * r2 * r2 + 6 * r2 * r2 * r2);
  EXPECT_TRUE(d.apply(xy).isApprox(radial * xy, 1e-14));
  EXPECT_EQ(Distortion::from_coefficients(d.coefficients()), d);
  EXPECT_FALSE(Distortion::from_coefficients(std::vector<double>(6, 0.0)));
}

}  // namespace
}  // namespace sgs
