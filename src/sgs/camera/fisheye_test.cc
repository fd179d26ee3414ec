// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "sgs/camera/register_depth.h"
#include "sgs/camera/seen_area.h"
#include "sgs/camera/undistort.h"

namespace sgs {
namespace {

// A T265's lens, on a picture of 640x480: 56 degrees off the axis at the corners.
const PinholeCamera kFisheyePinhole{640, 480, 405.0, 404.0, 321.3, 238.1};
const std::vector<double> kNumbers = {-0.0068, 0.0405, -0.0379, 0.0062};

Distortion fisheye(const std::vector<double>& numbers = kNumbers) {
  return *Distortion::from_coefficients(numbers, LensModel::kFisheye);
}

cv::Matx33d matrix(const PinholeCamera& c) { return {c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1}; }

TEST(Fisheye, PicturesDirectionsAsOpenCvDoes) {
  const Distortion lens = fisheye();
  std::vector<cv::Point2d> straight;
  for (double x = -3; x <= 3; x += 0.2) {
    for (double y = -2; y <= 2; y += 0.25) straight.emplace_back(x, y);
  }
  std::vector<cv::Point2d> theirs;
  cv::fisheye::distortPoints(straight, theirs, cv::Matx33d::eye(), cv::Mat(kNumbers));
  for (std::size_t i = 0; i < straight.size(); ++i) {
    const Eigen::Vector2d xy(straight[i].x, straight[i].y), mine = lens.apply(xy);
    EXPECT_LT((mine - Eigen::Vector2d(theirs[i].x, theirs[i].y)).norm(), 1e-12);
    const auto back = lens.invert(mine);
    ASSERT_TRUE(back) << xy.transpose();
    EXPECT_LT((*back - xy).norm(), 1e-8);
  }
}

TEST(Fisheye, HasNoDirectionBeyondItsFoldNorBesideTheCamera) {
  EXPECT_EQ(fisheye().fold_radius(), std::numeric_limits<double>::infinity());
  // theta (1 - 0.3 theta^2) turns back at 1.054, where it is 0.703.
  const Distortion folding = fisheye({-0.3, 0, 0, 0});
  EXPECT_NEAR(folding.fold_radius(), std::tan(1 / std::sqrt(0.9)), 2e-3);
  EXPECT_TRUE(folding.invert({0.70, 0}));
  EXPECT_FALSE(folding.invert({0.71, 0}));
  // Without coefficients the picture's radius is the angle: 1.4 is 80.2 degrees.
  const Distortion even = fisheye({});
  EXPECT_FALSE(even.is_zero());
  EXPECT_TRUE(even.invert({1.39, 0}));
  EXPECT_FALSE(even.invert({1.41, 0}));
  EXPECT_FALSE(even.invert({0, 3.2}));
}

TEST(Fisheye, CoefficientsAreFourAndComeBackAsTheyWere) {
  EXPECT_EQ(fisheye().written(), kNumbers);
  EXPECT_FALSE(Distortion::from_coefficients(std::vector<double>(5, 0.1), LensModel::kFisheye));
  EXPECT_NE(fisheye({}), Distortion{});
}

/// A smooth picture and a depth in steps, seen through nothing.
ColorImage painted(const PinholeCamera& c) {
  ColorImage out(c.width, c.height);
  for (int v = 0; v < c.height; ++v) {
    for (int u = 0; u < c.width; ++u) {
      const auto wave = [&](double a, double b) {
        return static_cast<std::uint8_t>(127 + 120 * std::sin(a * u + b * v));
      };
      out(u, v) = {wave(0.05, 0.01), wave(-0.02, 0.04), wave(0.03, 0.03)};
    }
  }
  return out;
}

TEST(Fisheye, PicturesAreUndistortedAsOpenCvDoes) {
  const Undistorter undistorter(kFisheyePinhole, fisheye());
  const ColorImage bent = painted(kFisheyePinhole);
  const ColorImage mine = undistorter.color(bent);
  cv::Mat map_x, map_y, theirs;
  cv::fisheye::initUndistortRectifyMap(
      matrix(kFisheyePinhole), cv::Mat(kNumbers), cv::Matx33d::eye(), matrix(kFisheyePinhole),
      {kFisheyePinhole.width, kFisheyePinhole.height}, CV_32F, map_x, map_y);
  const cv::Mat in(kFisheyePinhole.height, kFisheyePinhole.width, CV_8UC3,
                   const_cast<Rgb8*>(bent.data()));
  cv::remap(in, theirs, map_x, map_y, cv::INTER_LINEAR, cv::BORDER_CONSTANT);
  int most = 0;
  for (int v = 0; v < kFisheyePinhole.height; ++v) {
    for (int u = 0; u < kFisheyePinhole.width; ++u) {
      const auto& t = theirs.at<cv::Vec3b>(v, u);
      most = std::max(most, std::abs(int{t[0]} - int{mine(u, v).r}));
      most = std::max(most, std::abs(int{t[1]} - int{mine(u, v).g}));
    }
  }
  EXPECT_LE(most, 2);
  // A fisheye shows more than a pinhole camera of its focal length: nothing is missing.
  EXPECT_EQ(undistorter.seen(), nullptr);
}

TEST(Fisheye, WhatItDoesNotShowIsMasked) {
  // It pictures the rim farther out than a pinhole camera does.
  PinholeCamera narrow = kFisheyePinhole;
  narrow.cx = 60;
  const Distortion lens = fisheye({0.8, 0, 0, 0});
  const Undistorter undistorter(narrow, lens);
  ASSERT_NE(undistorter.seen(), nullptr);
  const DepthImage flat = undistorter.depth(DepthImage(narrow.width, narrow.height, 2.0f));
  int wrong = 0, outside = 0;
  for (int v = 0; v < narrow.height; ++v) {
    for (int u = 0; u < narrow.width; ++u) {
      const Eigen::Vector2d at = lens.apply(narrow.back_project(u, v, 1).head<2>());
      const double x = narrow.fx * at.x() + narrow.cx, y = narrow.fy * at.y() + narrow.cy;
      const double inside = std::min({x, y, narrow.width - 1 - x, narrow.height - 1 - y});
      if (std::abs(inside) < 0.6) continue;
      outside += inside < 0;
      wrong +=
          ((*undistorter.seen())(u, v) != 0) != (inside > 0) || (flat(u, v) > 0) != (inside > 0);
    }
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_GT(outside, 1000);
}

// A wall before a fisheye that measures depth comes out flat and where it is.
TEST(Fisheye, DepthIsBroughtIntoAPinholeCamera) {
  const PinholeCamera small{160, 120, 90, 90, 79.5, 59.5};
  const DepthRegistration registration({small, fisheye()}, {small, {}}, SE3{});
  const DepthImage out = registration(DepthImage(small.width, small.height, 1.5f));
  int holes = 0;
  for (std::size_t i = 0; i < out.size(); ++i) {
    holes += out.data()[i] == 0;
    if (out.data()[i] == 0) continue;
    EXPECT_FLOAT_EQ(out.data()[i], 1.5f);
  }
  EXPECT_EQ(holes, 0);
}

}  // namespace
}  // namespace sgs
