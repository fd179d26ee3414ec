// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/render/pose_information.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sgs::render {
namespace {

LossConfig color_only() {
  LossConfig loss;
  loss.color_weight = 4;
  loss.color_knee = 0.2f;
  loss.depth_weight = 0;
  return loss;
}

/// A coloured wall two metres away, seen from `T`.
TrainingImage view(const SE3& T) {
  TrainingImage image;
  image.camera = {80, 60, 70, 70, 39.5, 29.5};
  image.color = Image<Rgbf>(image.camera.width, image.camera.height);
  image.depth = DepthImage(image.camera.width, image.camera.height);
  for (int v = 0; v < image.camera.height; ++v) {
    for (int u = 0; u < image.camera.width; ++u) {
      const Eigen::Vector3d ray = T.R * image.camera.back_project(u, v, 1.0);
      const double z = (2.0 - T.t.z()) / ray.z();
      const Eigen::Vector3d p = T.t + z * ray;
      const auto value = [&](double a, double b, double c) {
        return static_cast<float>(0.5 + 0.2 * std::sin(a * p.x() + c) +
                                  0.2 * std::sin(b * p.y() - c));
      };
      image.color(u, v) = {value(7, 5, 0), value(4, 9, 1), value(11, 3, 2)};
      image.depth(u, v) = static_cast<float>(z);
    }
  }
  return image;
}

double squared_difference(const TrainingImage& a, const TrainingImage& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.color.size(); ++i) {
    const Rgbf &x = a.color.data()[i], &y = b.color.data()[i];
    for (const float e : {x.r - y.r, x.g - y.g, x.b - y.b}) {
      sum += static_cast<double>(e) * static_cast<double>(e);
    }
  }
  return sum;
}

TEST(PoseInformation, InformationIsWhatASmallMotionChangesInThePicture) {
  const LossConfig loss = color_only();
  const TrainingImage here = view(SE3{});
  const Matrix6d information = pose_information(here, loss);
  EXPECT_LT((information - information.transpose()).norm(), 1e-9 * information.norm());
  const auto expect_change = [&](const Vector6d& xi) {
    const double expected = 0.5 * xi.dot(information * xi);
    const double actual = 0.5 * static_cast<double>(loss.color_weight / loss.color_knee) *
                          squared_difference(view(SE3::exp(xi)), here);
    EXPECT_NEAR(actual / expected, 1, 0.1) << xi.transpose();
  };
  for (int k = 0; k < 6; ++k) expect_change(0.02 * Vector6d::Unit(k));
  // Pitch and yaw move the wall like a shift across it: they add up or nearly cancel.
  for (const double sign : {-1.0, 1.0}) {
    expect_change(0.02 * (Vector6d::Unit(0) + sign * Vector6d::Unit(4)));
    expect_change(0.02 * (Vector6d::Unit(1) + sign * Vector6d::Unit(3)));
  }
}

TEST(PoseInformation, DepthKnowsTheDistanceOfAWallAndItsTiltOnly) {
  LossConfig loss = color_only();
  loss.color_weight = 0;
  loss.depth_weight = 1;
  loss.depth_form = DepthForm::kAbsolute;
  const TrainingImage here = view(SE3{});
  const Matrix6d information = pose_information(here, loss);
  const double pixels = static_cast<double>(here.depth.size());
  // One per pixel over 2 cm; the frame's border is left out.
  EXPECT_NEAR(information(5, 5) / (pixels / 0.02), 1, 0.1);
  EXPECT_GT(information(0, 0), 0.02 * information(5, 5));
  EXPECT_GT(information(1, 1), 0.02 * information(5, 5));
  for (const int blind : {2, 3, 4}) {
    EXPECT_LT(information(blind, blind), 1e-4 * information(5, 5)) << blind;
  }
}

TEST(PoseInformation, ColorWithoutDepthCountsAtTheMeanDepth) {
  TrainingImage image = view(SE3{});
  const Matrix6d whole = pose_information(image, color_only());
  for (int y = 0; y < image.depth.height(); ++y) {
    for (int x = 0; x < image.depth.width() / 2; ++x) image.depth(x, y) = 0;
  }
  EXPECT_LT((pose_information(image, color_only()) - whole).norm(), 1e-3 * whole.norm());
  image.depth = DepthImage(image.depth.width(), image.depth.height());
  EXPECT_EQ(pose_information(image, color_only()).norm(), 0);
}

}  // namespace
}  // namespace sgs::render
