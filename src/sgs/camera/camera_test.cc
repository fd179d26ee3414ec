// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sgs/camera/depth_noise.h"
#include "sgs/camera/pair_rectifier.h"
#include "sgs/camera/pinhole.h"
#include "sgs/camera/undistort.h"

namespace sgs {
namespace {

const PinholeCamera kCamera{640, 480, 517.3, 516.5, 318.6, 255.3};
const Distortion kFr1{0.2624, -0.9531, -0.0054, 0.0026, 1.1633};

TEST(Pinhole, BackProjectionInvertsProjection) {
  for (const double z : {0.1, 1.0, 7.0}) {
    const Eigen::Vector3d p = kCamera.back_project(12.25, 400.5, z);
    EXPECT_EQ(p.z(), z);
    EXPECT_TRUE(kCamera.project(p).isApprox(Eigen::Vector2d(12.25, 400.5), 1e-13));
  }
}

TEST(Pinhole, ValidRefusesNonsense) {
  EXPECT_TRUE(kCamera.valid());
  EXPECT_FALSE(PinholeCamera{}.valid());
  PinholeCamera bad = kCamera;
  bad.cx = std::nan("");
  EXPECT_FALSE(bad.valid());
}

// The mean of a 2x2 block is centred between its pixels: full-size pixels 0 and 1 average to 0.5,
// which must be pixel 0 of the halved image.
TEST(Pinhole, HalvedKeepsPixelCentres) {
  for (int level = 0; level <= 3; ++level) {
    const PinholeCamera half = kCamera.halved(level);
    const int block = 1 << level;
    EXPECT_EQ(half.width, 640 / block);
    for (const int u : {0, 7, 59}) {
      const double centre = u * block + 0.5 * (block - 1);
      const Eigen::Vector3d p = kCamera.back_project(centre, centre, 2.0);
      EXPECT_NEAR(half.project(p).x(), u, 1e-10);
      EXPECT_NEAR(half.project(p).y(), u, 1e-10);
    }
  }
  EXPECT_EQ(kCamera.halved(1).halved(1), kCamera.halved(2));
}

TEST(Distortion, MatchesTheFormulaTermByTerm) {
  const Eigen::Vector2d xy(0.3, -0.2);
  const double r2 = 0.13;
  EXPECT_TRUE(Distortion{}.apply(xy).isApprox(xy));
  EXPECT_NEAR((Distortion{2, 0, 0, 0, 0}.apply(xy).x()), 0.3 * (1 + 2 * r2), 1e-15);
  EXPECT_NEAR((Distortion{0, 2, 0, 0, 0}.apply(xy).y()), -0.2 * (1 + 2 * r2 * r2), 1e-15);
  EXPECT_NEAR((Distortion{0, 0, 0, 0, 2}.apply(xy).x()), 0.3 * (1 + 2 * r2 * r2 * r2), 1e-15);
  EXPECT_NEAR((Distortion{0, 0, 2, 0, 0}.apply(xy).x()), 0.3 + 4 * 0.3 * -0.2, 1e-15);
  EXPECT_NEAR((Distortion{0, 0, 2, 0, 0}.apply(xy).y()), -0.2 + 2 * (r2 + 2 * 0.04), 1e-15);
  EXPECT_NEAR((Distortion{0, 0, 0, 2, 0}.apply(xy).x()), 0.3 + 2 * (r2 + 2 * 0.09), 1e-15);
}

/// Pixel at which the distorted camera sees a normalised image point.
Eigen::Vector2d distorted_pixel(const Eigen::Vector2d& xy) {
  const Eigen::Vector2d d = kFr1.apply(xy);
  return {kCamera.fx * d.x() + kCamera.cx, kCamera.fy * d.y() + kCamera.cy};
}

// Draws a soft dot where the distorted lens puts a point; after undistortion its centre of mass
// must lie where the pinhole projects that point.
TEST(Undistorter, DotsLandWhereThePinholeProjectsThem) {
  const Undistorter undistorter(kCamera, kFr1);
  double largest_shift = 0;
  for (const auto& xy : {Eigen::Vector2d(0, 0), Eigen::Vector2d(0.3, 0.2),
                         Eigen::Vector2d(-0.45, 0.25), Eigen::Vector2d(0.4, -0.35)}) {
    const Eigen::Vector2d seen = distorted_pixel(xy);
    const Eigen::Vector2d expected = kCamera.project({xy.x(), xy.y(), 1});
    largest_shift = std::max(largest_shift, (seen - expected).norm());
    ColorImage image(kCamera.width, kCamera.height);
    for (int y = 0; y < image.height(); ++y) {
      for (int x = 0; x < image.width(); ++x) {
        const double r2 = (Eigen::Vector2d(x, y) - seen).squaredNorm();
        const auto v = static_cast<std::uint8_t>(std::lround(255 * std::exp(-r2 / 18)));
        image(x, y) = {v, v, v};
      }
    }
    const ColorImage flat = undistorter.color(image);
    Eigen::Vector2d centre(0, 0);
    double mass = 0;
    for (int y = 0; y < flat.height(); ++y) {
      for (int x = 0; x < flat.width(); ++x) {
        mass += flat(x, y).g;
        centre += flat(x, y).g * Eigen::Vector2d(x, y);
      }
    }
    EXPECT_LT((centre / mass - expected).norm(), 0.1) << xy.transpose();
  }
  EXPECT_GT(largest_shift, 2.0);  // the test would not notice a lens that does nothing
}

// Depth that encodes the distorted column: each undistorted pixel must hold the measurement nearest
// to where the lens saw its ray, never a mixture.
TEST(Undistorter, DepthTakesTheNearestMeasurement) {
  const Undistorter undistorter(kCamera, kFr1);
  DepthImage depth(kCamera.width, kCamera.height);
  for (int y = 0; y < depth.height(); ++y) {
    for (int x = 0; x < depth.width(); ++x) depth(x, y) = static_cast<float>(1 + x);
  }
  const DepthImage flat = undistorter.depth(depth);
  for (int y = 20; y < 460; y += 11) {
    for (int x = 20; x < 620; x += 7) {
      const Eigen::Vector3d ray = kCamera.back_project(x, y, 1);
      const Eigen::Vector2d seen = distorted_pixel(ray.head<2>());
      if (seen.x() < 0 || seen.x() > 639 || seen.y() < 0 || seen.y() > 479) continue;
      const float column = flat(x, y) - 1;
      EXPECT_EQ(column, std::floor(column));
      EXPECT_LE(std::abs(column - seen.x()), 0.55) << x << " " << y;
    }
  }
}

TEST(Undistorter, ZeroDistortionChangesNothingAndSizesAreChecked) {
  const Undistorter undistorter(kCamera, {});
  ColorImage image(kCamera.width, kCamera.height);
  for (std::size_t i = 0; i < image.size(); ++i) {
    image.data()[i] = {static_cast<std::uint8_t>(i * 7), static_cast<std::uint8_t>(i / 640), 3};
  }
  const ColorImage out = undistorter.color(image);
  for (std::size_t i = 0; i < image.size(); ++i) ASSERT_EQ(out.data()[i], image.data()[i]) << i;
  EXPECT_THROW(undistorter.color(ColorImage(3, 3)), ContractViolation);
}

TEST(DepthNoise, GrowsWithRange) {
  EXPECT_NEAR(depth_sigma_m(0.4f), 0.0012, 1e-6);
  EXPECT_NEAR(depth_sigma_m(3.4f), 0.0012 + 0.0019 * 9, 1e-5);
}

template <class Pixel>
bool same(const Image<Pixel>& a, const Image<Pixel>& b) {
  return std::equal(a.data(), a.data() + a.size(), b.data(), b.data() + b.size());
}

TEST(PairRectifier, DoesWhatItsPartsDo) {
  ColorImage color(kCamera.width, kCamera.height);
  DepthImage depth(kCamera.width, kCamera.height);
  for (std::size_t i = 0; i < color.size(); ++i) {
    color.data()[i].g = static_cast<std::uint8_t>(i % 251);
    depth.data()[i] = 1 + 0.001f * static_cast<float>(i % 97);
  }
  const SE3 T_color_depth(Eigen::Matrix3d::Identity(), {0.02, 0, 0});
  const Undistorter undistorter(kCamera, kFr1);
  RgbdFrame frame;
  PairRectifier one_camera({kCamera, kFr1}, std::nullopt, {});
  one_camera.rectify(color, depth, frame);
  EXPECT_TRUE(same(frame.color, undistorter.color(color)));
  EXPECT_TRUE(same(frame.depth, undistorter.depth(depth)));
  PairRectifier two_cameras({kCamera, kFr1}, LensCamera{kCamera, {}}, T_color_depth);
  two_cameras.rectify(color, depth, frame);
  EXPECT_TRUE(same(frame.color, undistorter.color(color)));
  EXPECT_TRUE(
      same(frame.depth, DepthRegistration({kCamera, {}}, {kCamera, {}}, T_color_depth)(depth)));
}

TEST(PairRectifier, TakesNothingOnTheWordOfACamera) {
  const PinholeCamera huge{1 << 20, 1 << 20, 500, 500, 320, 240};
  EXPECT_EQ(PairRectifier({huge, kFr1}, LensCamera{huge, kFr1}, {}).depth_camera().width, 1 << 20);
}

}  // namespace
}  // namespace sgs
