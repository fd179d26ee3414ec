// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/render/view_color.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>

#include "sgs/geometry/se3.h"
#include "sgs/render/rasterizer.h"
#include "sgs/render/test_scene.h"

namespace sgs::render {
namespace {

map::Harmonics random_harmonics(int degree, std::size_t count, unsigned seed) {
  map::Harmonics harmonics{degree, {}};
  harmonics.resize(count);
  std::mt19937 generator(seed);
  std::normal_distribution<float> spread(0, 0.2f);
  for (float& c : harmonics.coefficients) c = spread(generator);
  return harmonics;
}

map::Gaussian at(float x, float y, float z) {
  map::Gaussian g{};
  g.mean[0] = x;
  g.mean[1] = y;
  g.mean[2] = z;
  g.rotation[0] = 1;
  for (float& c : g.rgb) c = 0.5f;
  return g;
}

TEST(ViewColor, WithoutHarmonicsTheGaussiansThemselvesAreSeen) {
  const std::vector<map::Gaussian> gaussians = {at(0, 0, 2)};
  ViewColors colors(nullptr);
  EXPECT_EQ(colors.seen(gaussians, {}, Eigen::Vector3d::Zero()).data(), gaussians.data());
}

// The order and the signs of 3D Gaussian Splatting: coefficients times -y, z, -x.
TEST(ViewColor, DegreeOneFollowsTheDirectionFromCameraToMean) {
  const std::vector<map::Gaussian> gaussians = {at(0, 0, 2)};
  map::Harmonics harmonics{1, std::vector<float>(9)};
  const auto c = harmonics.of(0);
  c[0] = 0.1f;      // red by -y
  c[3 + 1] = 0.2f;  // green by z
  c[6 + 2] = 0.3f;  // blue by -x
  constexpr float k = 0.4886025f;
  std::vector<map::Gaussian> seen;
  color_towards(gaussians, harmonics, {0, -5, 2}, seen, nullptr);  // from above: along +y
  EXPECT_NEAR(seen[0].rgb[0], 0.5f - 0.1f * k, 1e-6f);
  EXPECT_NEAR(seen[0].rgb[1], 0.5f, 1e-6f);
  color_towards(gaussians, harmonics, {0, 0, -1}, seen, nullptr);  // along +z
  EXPECT_NEAR(seen[0].rgb[1], 0.5f + 0.2f * k, 1e-6f);
  color_towards(gaussians, harmonics, {-4, 0, 2}, seen, nullptr);  // along +x
  EXPECT_NEAR(seen[0].rgb[2], 0.5f - 0.3f * k, 1e-6f);
}

TEST(ViewColor, NoColourIsTakenOutOfItsRange) {
  std::vector<map::Gaussian> gaussians = {at(0, 0, 2)};
  gaussians[0].rgb[2] = 1.3f;  // was outside before
  map::Harmonics harmonics{1, std::vector<float>(9)};
  const auto c = harmonics.of(0);
  c[3] = -5;
  c[3 + 1] = 5;
  c[3 + 2] = 5;
  std::vector<map::Gaussian> seen;
  color_towards(gaussians, harmonics, {0, 0, -1}, seen, nullptr);
  EXPECT_THAT(seen[0].rgb, ::testing::ElementsAre(0.0f, 1.0f, 1.3f));
  // Derivatives that lead further out are none; those that lead back count.
  std::vector<float> gradient(9);
  for (const float sign : {1.0f, -1.0f}) {
    map::Gaussian row{};
    row.rgb[0] = sign;
    row.rgb[1] = -sign;
    color_backward(gaussians[0], harmonics.of(0), 1, {0, 0, -1}, row, gradient);
    EXPECT_EQ(row.rgb[0], sign > 0 ? 0 : -1);
    EXPECT_EQ(row.rgb[1], sign > 0 ? 0 : 1);
    EXPECT_EQ(gradient[3] == 0, sign > 0);
  }
}

// Basis functions are orthonormal on the sphere: a wrong constant or sign of a term shows.
TEST(ViewColor, BasisFunctionsAreOrthonormal) {
  constexpr int kDegree = 3;
  constexpr std::size_t kFunctions = map::Harmonics::basis_functions(kDegree);
  constexpr float kSmall = 0.2f;  // nothing is clamped
  // One Gaussian per basis function and channel red, all in one place.
  std::vector<map::Gaussian> gaussians(kFunctions, at(0, 0, 0));
  map::Harmonics harmonics{kDegree, std::vector<float>(3 * kFunctions * kFunctions)};
  for (std::size_t k = 0; k < kFunctions; ++k) harmonics.of(k)[3 * k] = kSmall;
  std::vector<std::vector<double>> products(kFunctions, std::vector<double>(kFunctions, 0));
  constexpr int kDirections = 4000;
  std::vector<map::Gaussian> seen;
  for (int i = 0; i < kDirections; ++i) {  // even spirals
    const double z = 1 - (2.0 * i + 1) / kDirections, turn = 2.39996322972865332 * i;
    const double r = std::sqrt(1 - z * z);
    color_towards(gaussians, harmonics, {-r * std::cos(turn), -r * std::sin(turn), -z}, seen,
                  nullptr);
    for (std::size_t a = 0; a < kFunctions; ++a) {
      for (std::size_t b = 0; b < kFunctions; ++b) {
        products[a][b] += (seen[a].rgb[0] - 0.5) * (seen[b].rgb[0] - 0.5) / (kSmall * kSmall);
      }
    }
  }
  for (std::size_t a = 0; a < kFunctions; ++a) {
    for (std::size_t b = 0; b < kFunctions; ++b) {
      EXPECT_NEAR(products[a][b] * 4 * M_PI / kDirections, a == b ? 1 : 0, 2e-3) << a << " " << b;
    }
  }
}

TEST(ViewColor, SameBitsForAnyNumberOfThreads) {
  std::vector<map::Gaussian> gaussians;
  for (int i = 0; i < 10000; ++i) gaussians.push_back(at(0.01f * i, 1, 2));
  const map::Harmonics harmonics = random_harmonics(3, gaussians.size(), 1);
  std::vector<map::Gaussian> one, three;
  ThreadPool pool(3);
  color_towards(gaussians, harmonics, {0.3, 0.2, 0.1}, one, nullptr);
  color_towards(gaussians, harmonics, {0.3, 0.2, 0.1}, three, &pool);
  EXPECT_EQ(std::memcmp(one.data(), three.data(), one.size() * sizeof(map::Gaussian)), 0);
}

/// Central difference of `value` by `parameter`.
template <class Value>
double difference(float& parameter, float step, const Value& value) {
  const float kept = parameter;
  parameter = kept + step;
  const float high = parameter;
  const double above = value();
  parameter = kept - step;
  const double below = value(), width = static_cast<double>(high) - parameter;
  parameter = kept;
  return (above - below) / width;
}

// Coefficients and means, for a loss that is a weighted sum of the colours.
TEST(ViewColor, DerivativesAreThoseOfTheColour) {
  const Eigen::Vector3d center(0.4, -0.3, -0.5);
  constexpr float kWeights[] = {0.7f, -1.1f, 0.5f};
  for (int degree = 1; degree <= map::kMaxHarmonicDegree; ++degree) {
    std::vector<map::Gaussian> gaussians = {at(0.3f, 0.2f, 0.9f), at(-0.8f, 0.1f, 0.2f)};
    map::Harmonics harmonics = random_harmonics(degree, gaussians.size(), 7);
    std::vector<map::Gaussian> seen;
    for (std::size_t i = 0; i < gaussians.size(); ++i) {
      const auto loss = [&] {
        color_towards(gaussians, harmonics, center, seen, nullptr);
        double sum = 0;
        for (int c = 0; c < 3; ++c) sum += double{kWeights[c]} * double{seen[i].rgb[c]};
        return sum;
      };
      map::Gaussian row{};
      std::copy_n(kWeights, 3, row.rgb);
      std::vector<float> analytic(harmonics.floats());
      color_backward(gaussians[i], harmonics.of(i), degree, center, row, analytic);
      for (std::size_t k = 0; k < analytic.size(); ++k) {
        EXPECT_NEAR(analytic[k], difference(harmonics.of(i)[k], 0.1f, loss), 1e-5)
            << "degree " << degree << " coefficient " << k;
      }
      for (int k = 0; k < 3; ++k) {
        EXPECT_NEAR(row.mean[k], difference(gaussians[i].mean[k], 4e-3f, loss), 2e-4)
            << "degree " << degree << " mean " << k;
      }
    }
  }
}

// The way a refinement goes: colours for the view, a picture, its loss, and back.
TEST(ViewColor, CoefficientsFollowTheLossOfAPicture) {
  testing::Random random(3);
  const PinholeCamera camera = testing::small_camera(48, 37);
  const SE3 pose = testing::tilted_pose();
  auto gaussians = testing::random_gaussians(camera, pose, 12, 4.0, random);
  map::Harmonics harmonics = random_harmonics(2, gaussians.size(), 7);
  // No colour at an end of its range.
  for (map::Gaussian& g : gaussians) {
    for (float& c : g.rgb) c = 0.4f + 0.2f * c;
  }
  for (float& c : harmonics.coefficients) c *= 0.1f;
  const auto rasterizer = make_reference_rasterizer();
  ViewColors colors(nullptr);
  Rendering rendering;
  rasterizer->render(colors.seen(gaussians, harmonics, pose.t), camera, pose, rendering);
  const TrainingImage image = testing::training_image_beside(rendering, camera, random);
  LossConfig config;
  config.color_knee = 0.1f;
  Gradients gradients, scratch;
  rasterizer->evaluate(colors.seen(gaussians, harmonics, pose.t), image, pose, config, gradients);
  ASSERT_GT(gradients.visible.size(), 5u);
  const auto loss = [&] {
    rasterizer->evaluate(colors.seen(gaussians, harmonics, pose.t), image, pose, config, scratch);
    return scratch.loss;
  };
  double largest = 0;
  for (std::size_t n = 0; n < gradients.visible.size(); ++n) {
    const std::size_t i = gradients.visible[n];
    std::vector<float> analytic(harmonics.floats());
    color_backward(gaussians[i], harmonics.of(i), 2, pose.t, gradients.gradient[n], analytic);
    for (std::size_t k = 0; k < analytic.size(); k += 5) {
      const double numeric = difference(harmonics.of(i)[k], 2e-3f, loss);
      largest = std::max(largest, std::abs(numeric));
      EXPECT_NEAR(analytic[k], numeric, 2e-2 * std::abs(numeric) + 1e-3) << i << " " << k;
    }
  }
  EXPECT_GT(largest, 0.1);
}

TEST(ViewColor, TurnedHarmonicsShowAlongTurnedDirectionsWhatTheyShowedBefore) {
  const Eigen::Matrix3d R = so3_exp({0.4, -1.1, 0.7});
  for (int degree = 1; degree <= map::kMaxHarmonicDegree; ++degree) {
    const map::Harmonics before = random_harmonics(degree, 3, 5);
    map::Harmonics after = before;
    turn_harmonics(R, after);
    const std::vector<map::Gaussian> gaussians(3, at(0, 0, 0));
    std::vector<map::Gaussian> seen, seen_turned;
    for (const Eigen::Vector3d& center :
         {Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(-2, 1, -0.3), Eigen::Vector3d(0, 0, -1)}) {
      color_towards(gaussians, before, center, seen, nullptr);
      color_towards(gaussians, after, R * center, seen_turned, nullptr);
      for (std::size_t i = 0; i < 3; ++i) {
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(seen[i].rgb[k], seen_turned[i].rgb[k], 1e-5f);
      }
    }
  }
}

}  // namespace
}  // namespace sgs::render
