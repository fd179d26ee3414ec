// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <Eigen/Dense>
#include <cmath>

#include "sgs/render/reference/reference_scene.h"
#include "sgs/render/test_scene.h"

namespace sgs::render::reference {
namespace {

using render::testing::Random;

struct Scene {
  PinholeCamera camera;
  SE3 pose;
  std::vector<Parameters> gaussians;
  TrainingImage training;
};

Scene make_scene(std::uint64_t seed, int count = 25) {
  Random random(seed);
  Scene s{render::testing::small_camera(48, 37), render::testing::tilted_pose(), {}, {}};
  for (const auto& g : render::testing::random_gaussians(s.camera, s.pose, count, 4.0, random)) {
    s.gaussians.push_back(to_parameters(g));
  }
  auto rasterizer = make_reference_rasterizer();
  std::vector<map::Gaussian> rows;
  Random again(seed);
  rows = render::testing::random_gaussians(s.camera, s.pose, count, 4.0, again);
  Rendering rendering;
  rasterizer->render(rows, s.camera, s.pose, rendering);
  s.training = render::testing::training_image_beside(rendering, s.camera, random);
  return s;
}

double loss_of(const Scene& s, const std::vector<Parameters>& gaussians, const SE3& pose,
               const LossConfig& loss) {
  return evaluate(gaussians, s.training, pose, loss, {}, false).loss;
}

/// Central difference, or NaN where two step sizes disagree: there a pixel crossed the 1/255 cut or
/// another jump of the renderer.
template <class Loss>
double derivative(const Loss& loss) {
  const auto central = [&](double h) { return (loss(h) - loss(-h)) / (2 * h); };
  const double a = central(2e-6), b = central(7e-7);
  return std::abs(a - b) < 1e-4 + 1e-4 * std::abs(a) ? a : std::nan("");
}

void expect_gradients_match(const Scene& s, const LossConfig& loss) {
  const Evaluation e = evaluate(s.gaussians, s.training, s.pose, loss);
  const char* const names[kParameters] = {"mean",    "mean",     "mean",     "scale",    "scale",
                                          "scale",   "rotation", "rotation", "rotation", "rotation",
                                          "opacity", "rgb",      "rgb",      "rgb"};
  int checked = 0, skipped = 0;
  double largest = 0;
  for (std::size_t i = 0; i < s.gaussians.size(); ++i) {
    for (std::size_t k = 0; k < kParameters; ++k) {
      const double numeric = derivative([&](double h) {
        auto moved = s.gaussians;
        moved[i][k] += h;
        return loss_of(s, moved, s.pose, loss);
      });
      if (std::isnan(numeric)) {
        ++skipped;
        continue;
      }
      ++checked;
      largest = std::max(largest, std::abs(numeric));
      EXPECT_NEAR(e.gradient[i][k], numeric, 2e-4 + 2e-4 * std::abs(numeric))
          << names[k] << " of Gaussian " << i;
    }
  }
  EXPECT_GT(largest, 1.0);
  EXPECT_LT(skipped, checked / 10);
}

void expect_twist_matches(const Scene& s, const LossConfig& loss) {
  const Evaluation e = evaluate(s.gaussians, s.training, s.pose, loss);
  int checked = 0;
  for (int k = 0; k < 6; ++k) {
    const double numeric = derivative([&](double h) {
      Vector6d xi = Vector6d::Zero();
      xi[k] = h;
      return loss_of(s, s.gaussians, s.pose * SE3::exp(xi), loss);
    });
    if (std::isnan(numeric)) continue;
    ++checked;
    EXPECT_NEAR(e.camera_twist[k], numeric, 1e-3 + 2e-4 * std::abs(numeric)) << "twist " << k;
  }
  EXPECT_GE(checked, 4);
}

TEST(ReferenceGradient, DefaultLoss) {
  const Scene s = make_scene(1);
  expect_gradients_match(s, {});
  expect_twist_matches(s, {});
}

TEST(ReferenceGradient, AbsoluteDepthOnlyWhereDepthWithGains) {
  LossConfig loss;
  loss.depth_form = DepthForm::kAbsolute;
  loss.color_only_where_depth = true;
  loss.gain = {1.2f, 0.9f, 1.05f};
  // The training keeps away from the kinks of gain 1 only; move it along.
  Scene s = make_scene(2);
  for (std::size_t i = 0; i < s.training.color.size(); ++i) {
    Rgbf& c = s.training.color.data()[i];
    c = {c.r + 1.0f, c.g - 1.0f, c.b + 1.0f};
    s.training.depth.data()[i] *= 2;
  }
  expect_gradients_match(s, loss);
  expect_twist_matches(s, loss);
}

TEST(ReferenceGradient, RoundedResiduals) {
  // Knees on either side of most residuals.
  for (const float knee : {0.1f, 10.0f}) {
    LossConfig loss;
    loss.color_weight = 0.8f + knee;
    loss.depth_weight = 0.2f + knee;
    loss.color_knee = knee;
    loss.depth_knee_m = knee;
    loss.gain = {1.2f, 0.9f, 1.05f};
    expect_gradients_match(make_scene(5), loss);
    expect_twist_matches(make_scene(5), loss);
  }
}

TEST(ReferenceGradient, Dssim) {
  LossConfig loss;
  loss.color_weight = 0;
  loss.depth_weight = 0;
  loss.dssim_weight = 1;
  loss.gain = {0.8f, 1.1f, 1.0f};
  const Scene s = make_scene(3, 12);
  expect_gradients_match(s, loss);
  expect_twist_matches(s, loss);
}

TEST(ReferenceGradient, WhatWasNotSeenHasNoPart) {
  LossConfig loss;
  loss.dssim_weight = 0.5f;
  Scene s = make_scene(3, 12);
  for (int y = 0; y < s.training.depth.height(); ++y) {
    for (int x = 0; x < 3; ++x) s.training.depth(x, y) = TrainingImage::kUnseen;
  }
  expect_gradients_match(s, loss);
  expect_twist_matches(s, loss);
  const double before = evaluate(s.gaussians, s.training, s.pose, loss).loss;
  for (int y = 0; y < s.training.depth.height(); ++y) {
    for (int x = 0; x < 3; ++x) s.training.color(x, y) = {9, 9, 9};
  }
  EXPECT_EQ(evaluate(s.gaussians, s.training, s.pose, loss).loss, before);
}

TEST(ReferenceGradient, FloatersGetNone) {
  Scene s = make_scene(4);
  for (std::size_t i = 0; i < s.training.depth.size(); ++i) s.training.depth.data()[i] = 10.0f;
  LossConfig loss;
  loss.floater_margin_m = 0.2f;
  const Evaluation e = evaluate(s.gaussians, s.training, s.pose, loss);
  EXPECT_GT(e.loss, 0);
  for (const auto& row : e.gradient) EXPECT_THAT(row, ::testing::Each(0.0));
  loss.floater_margin_m = 20.0f;
  const Evaluation all = evaluate(s.gaussians, s.training, s.pose, loss);
  loss.floater_margin_m = 0.0f;
  EXPECT_EQ(all.gradient, evaluate(s.gaussians, s.training, s.pose, loss).gradient);
}

/// The projection once more in matrices as the papers write it, so that a mistake shared by all
/// renderers shows.
TEST(ReferenceProjection, EqualsMatrixFormula) {
  const Scene s = make_scene(5, 40);
  const auto splats = project_all(s.gaussians, s.camera, s.pose);
  ASSERT_GT(splats.size(), 20u);
  const SE3 T_cw = s.pose.inverse();
  for (const auto& splat : splats) {
    const Parameters& g = s.gaussians[splat.source];
    const Eigen::Vector3d p = T_cw * Eigen::Vector3d(g[0], g[1], g[2]);
    const Eigen::Vector2d uv = s.camera.project(p);
    EXPECT_NEAR(splat.x, uv.x(), 1e-9);
    EXPECT_NEAR(splat.y, uv.y(), 1e-9);
    EXPECT_NEAR(splat.z, p.z(), 1e-12);
    const Eigen::Matrix3d Q =
        Eigen::Quaterniond(g[6], g[7], g[8], g[9]).normalized().toRotationMatrix();
    const Eigen::Vector3d scale(std::exp(g[3]), std::exp(g[4]), std::exp(g[5]));
    const Eigen::Matrix3d cov = Q * scale.cwiseAbs2().asDiagonal() * Q.transpose();
    Eigen::Matrix<double, 2, 3> J;
    J << s.camera.fx / p.z(), 0, -s.camera.fx * p.x() / (p.z() * p.z()), 0, s.camera.fy / p.z(),
        -s.camera.fy * p.y() / (p.z() * p.z());
    const Eigen::Matrix2d image_cov =
        J * T_cw.R * cov * T_cw.R.transpose() * J.transpose() + 0.3 * Eigen::Matrix2d::Identity();
    const Eigen::Matrix2d conic = image_cov.inverse();
    EXPECT_NEAR(splat.conic_xx, conic(0, 0), 1e-6);
    EXPECT_NEAR(splat.conic_xy, conic(0, 1), 1e-6);
    EXPECT_NEAR(splat.conic_yy, conic(1, 1), 1e-6);
    EXPECT_NEAR(std::exp2(splat.log2_opacity), 1 / (1 + std::exp(-g[10])), 1e-6);
  }
}

TEST(ReferenceComposite, TwoGaussiansByHand) {
  const PinholeCamera camera{9, 9, 10, 10, 4, 4};
  std::vector<Parameters> g(2);
  g[0] = {0, 0, 2, -3, -3, -3, 1, 0, 0, 0, 0, 1, 0, 0};  // opacity 1/2, red, 2 m
  g[1] = {0, 0, 1, -3, -3, -3, 1, 0, 0, 0, 0, 0, 1, 0};  // opacity 1/2, green, in front
  const auto image = composite(project_all(g, camera, SE3()), camera);
  const Pixel& centre = image[4 * 9 + 4];
  EXPECT_NEAR(centre[0], 0.25, 1e-6);
  EXPECT_NEAR(centre[1], 0.5, 1e-6);
  EXPECT_NEAR(centre[2], 0, 1e-12);
  EXPECT_NEAR(centre[3], 0.5 * 1 + 0.25 * 2, 1e-6);
  EXPECT_NEAR(centre[4], 0.75, 1e-6);
}

TEST(ReferenceDssim, EqualImagesGiveZero) {
  Random random(6);
  std::vector<double> x(20 * 15);
  for (double& v : x) v = random.uniform(0, 1);
  std::vector<double> gradient;
  EXPECT_NEAR(dssim(x, x, 20, 15, gradient), 0, 1e-12);
  for (const double g : gradient) EXPECT_NEAR(g, 0, 1e-9);
}

}  // namespace
}  // namespace sgs::render::reference
