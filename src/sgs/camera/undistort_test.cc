// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/camera/undistort.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "sgs/camera/seen_area.h"

namespace sgs {
namespace {

const PinholeCamera kLensCamera{640, 480, 517.3, 516.5, 318.6, 255.3};
const PinholeCamera kWide{320, 240, 120, 120, 159.5, 119.5};  // 59 degrees off the axis at corners

/// Whether the lens shows what lies on a pixel's ray; empty where rounding decides.
std::optional<bool> shown(const PinholeCamera& c, const Distortion& lens, double fold, int u,
                          int v) {
  constexpr double kRounding_px = 0.02;
  const Eigen::Vector2d xy = c.back_project(u, v, 1).head<2>(), d = lens.apply(xy);
  const double x = c.fx * d.x() + c.cx, y = c.fy * d.y() + c.cy;
  const double inside = std::min({x, y, c.width - 1 - x, c.height - 1 - y});
  const double before_fold = (fold - xy.norm()) * c.fx;
  if (std::abs(inside) < kRounding_px || std::abs(before_fold) < 1) return {};
  return inside > 0 && before_fold > 0;
}

/// Compares each pixel of the mask; returns the share that was seen.
double check_mask(const PinholeCamera& camera, const Distortion& lens, double fold) {
  const Undistorter undistorter(camera, lens);
  if (!undistorter.seen()) return 1;
  const PixelMask& seen = *undistorter.seen();
  int wrong = 0;
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const auto want = shown(camera, lens, fold, u, v);
      wrong += want && *want != (seen(u, v) != 0);
    }
  }
  EXPECT_EQ(wrong, 0);
  return seen_share(seen);
}

constexpr double kNever = std::numeric_limits<double>::infinity();

TEST(SeenPixels, OfAPincushionTheBorderIsMissing) {
  const Distortion lens{0.2624, -0.9531, -0.0054, 0.0026, 1.1633};
  const double share = check_mask(kLensCamera, lens, kNever);
  EXPECT_GT(share, 0.93);
  EXPECT_LT(share, 0.97);
}

TEST(SeenPixels, OfABarrelAllAreSeenUpToWhereItFoldsBack) {
  const Distortion lens{-0.3, 0, 0, 0, 0};
  EXPECT_EQ(check_mask(kLensCamera, lens, kNever), 1);
  // Beyond the fold the formula leads back into the picture.
  const double share = check_mask(kWide, lens, 1 / std::sqrt(0.9));
  EXPECT_LT(share, 0.75);
  EXPECT_GT(share, 0.4);
}

TEST(SeenPixels, OfARationalLens) {
  Distortion lens;
  lens.k4 = -0.1;  // pincushion
  EXPECT_LT(check_mask(kLensCamera, lens, kNever), 0.99);
  lens.k4 = 0.4;
  EXPECT_EQ(check_mask(kLensCamera, lens, kNever), 1);
  check_mask(kWide, lens, 1 / std::sqrt(0.4));
}

TEST(SeenPixels, WithoutALensAllAre) { EXPECT_EQ(Undistorter(kLensCamera, {}).seen(), nullptr); }

TEST(FoldRadius, IsWhereWhatIsFartherOutStopsBeingPicturedFartherOut) {
  constexpr double kStep = 2e-3;
  EXPECT_EQ((Distortion{}.fold_radius()), kNever);
  EXPECT_EQ((Distortion{0.2624, -0.9531, -0.0054, 0.0026, 1.1633}.fold_radius()), kNever);
  // d/dr r (1 + k r^2) = 0
  EXPECT_NEAR((Distortion{-0.3, 0, 0, 0, 0}.fold_radius()), 1 / std::sqrt(0.9), kStep);
  // d/dr r (1 + k r^4) = 0
  EXPECT_NEAR((Distortion{0, -0.2, 0, 0, 0}.fold_radius()), 1, kStep);
  // d/dr r / (1 + k r^2) = 0, and where the denominator vanishes
  EXPECT_NEAR((Distortion{0, 0, 0, 0, 0, 0.25, 0, 0}.fold_radius()), 2, kStep);
  EXPECT_NEAR((Distortion{0, 0, 0, 0, 0, -0.25, 0, 0}.fold_radius()), 2, kStep);
}

// What the formula leads back to is seen elsewhere: it must not be there twice.
TEST(SeenPixels, NoDepthComesFromBeyondTheFold) {
  const Distortion lens{-0.3, 0, 0, 0, 0};
  const Undistorter undistorter(kWide, lens);
  const DepthImage flat = undistorter.depth(DepthImage(kWide.width, kWide.height, 2.0f));
  const ColorImage color =
      undistorter.color(ColorImage(kWide.width, kWide.height, {200, 200, 200}));
  ASSERT_NE(undistorter.seen(), nullptr);
  int wrong = 0;
  for (int v = 0; v < kWide.height; ++v) {
    for (int u = 0; u < kWide.width; ++u) {
      const double radius = kWide.back_project(u, v, 1).head<2>().norm();
      if (radius < lens.fold_radius()) continue;
      wrong += flat(u, v) > 0 || color(u, v) != Rgb8{} || (*undistorter.seen())(u, v) != 0;
    }
  }
  EXPECT_EQ(wrong, 0);
}

// A mask of the distorted picture goes where its pixels go.
TEST(SeenPixels, MaskOfThePictureIsUndistortedWithIt) {
  const Distortion lens{0.2624, -0.9531, -0.0054, 0.0026, 1.1633};
  const Undistorter undistorter(kLensCamera, lens);
  PixelMask mask(kLensCamera.width, kLensCamera.height, std::uint8_t{1});
  DepthImage depth(kLensCamera.width, kLensCamera.height, 1.0f);
  for (int v = 100; v < 160; ++v) {
    std::fill_n(mask.row(v) + 200, 90, std::uint8_t{0});
    std::fill_n(depth.row(v) + 200, 90, 0.0f);
  }
  const PixelMask out = undistorter.mask(mask);
  const DepthImage flat = undistorter.depth(depth);
  int differ = 0;
  for (int v = 0; v < kLensCamera.height; ++v) {
    for (int u = 0; u < kLensCamera.width; ++u) {
      const bool seen = (*undistorter.seen())(u, v) != 0;
      differ += (out(u, v) != 0) != (seen && flat(u, v) > 0);
    }
  }
  EXPECT_EQ(differ, 0);
  EXPECT_LT(seen_share(out), seen_share(*undistorter.seen()));
  EXPECT_THROW(undistorter.mask(PixelMask(3, 3)), ContractViolation);
}

}  // namespace
}  // namespace sgs
