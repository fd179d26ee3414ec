// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/registration/cloud_sampler.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "sgs/camera/depth_noise.h"

namespace sgs::registration {
namespace {

const PinholeCamera kCamera{320, 240, 270, 268, 159.3, 121.1};

// Depth of the plane n.p = d, camera frame.
DepthImage plane_depth(const Eigen::Vector3d& n, double d) {
  DepthImage depth(kCamera.width, kCamera.height);
  for (int v = 0; v < depth.height(); ++v) {
    for (int u = 0; u < depth.width(); ++u) {
      const double along = n.dot(kCamera.back_project(u, v, 1.0));
      const double z = d / along;
      depth(u, v) = z > 0 && z < 20 ? static_cast<float>(z) : 0.0f;
    }
  }
  return depth;
}

SourceCloud sample(const DepthImage& depth, const SamplingConfig& config, bool ellipses = false) {
  SourceCloud cloud;
  make_sampler(config, kCamera, ellipses)->sample(depth, cloud);
  return cloud;
}

double angle_deg(const Eigen::Vector3f& a, const Eigen::Vector3d& b) {
  return std::acos(std::clamp(a.cast<double>().dot(b), -1.0, 1.0)) * 180 / std::numbers::pi;
}

TEST(PlaneFitSampler, ExactPlaneGivesExactPointsNormalsAndNoise) {
  const SamplingConfig config;
  const Eigen::Vector3d n = Eigen::Vector3d(-0.4, 0.2, -0.9).normalized();  // faces the camera
  const double d = -1.5;
  const SourceCloud cloud = sample(plane_depth(n, d), config);
  ASSERT_GT(cloud.points.size(), 1000u);
  for (const SourcePoint& p : cloud.points) {
    EXPECT_LT(angle_deg(p.normal, n), 0.1);
    EXPECT_NEAR(p.point.cast<double>().dot(n), d, 2e-4);
    const Eigen::Vector2d uv = kCamera.project(p.point.cast<double>());
    EXPECT_NEAR(uv.x(), p.u, 1e-2);
    EXPECT_NEAR(uv.y(), p.v, 1e-2);
    // Equation of the header with 4 independent samples and the floor of 1 mm.
    const double sigma_z = depth_sigma_m(p.point.z());
    const double along = -n.dot(p.point.cast<double>()) / p.point.z();
    EXPECT_NEAR(std::sqrt(p.variance_m2), std::hypot(sigma_z * along / 2, 1e-3), 2e-5);
  }
}

TEST(PlaneFitSampler, NormalsOfANoisyPlaneScatterAsPredicted) {
  const Eigen::Vector3d n = Eigen::Vector3d(0.3, 0.1, -1).normalized();
  DepthImage depth = plane_depth(n, -1.8);
  std::uint64_t state = 12345;
  const auto uniform = [&state] {
    state = state * 6364136223846793005ull + 1442695040888963407ull;
    return static_cast<double>(state >> 11) / 9007199254740992.0;
  };
  for (int v = 0; v < depth.height(); ++v) {
    for (int u = 0; u < depth.width(); ++u) {
      const double gauss =
          std::sqrt(-2 * std::log(uniform() + 1e-300)) * std::cos(2 * std::numbers::pi * uniform());
      depth(u, v) += static_cast<float>(gauss) * depth_sigma_m(depth(u, v));
    }
  }
  const SourceCloud cloud = sample(depth, SamplingConfig{});
  ASSERT_GT(cloud.points.size(), 800u);
  double normal2 = 0, expected2 = 0;
  for (const SourcePoint& p : cloud.points) {
    normal2 += (p.normal.cast<double>() - n).squaredNorm() / 2;  // per tangent direction
    expected2 += static_cast<double>(p.normal_sigma) * static_cast<double>(p.normal_sigma);
  }
  const double ratio = std::sqrt(normal2 / expected2);
  EXPECT_GT(ratio, 0.5);
  EXPECT_LT(ratio, 1.6);
}

TEST(PlaneFitSampler, NoPointMixesTheTwoSidesOfADepthEdge) {
  DepthImage depth(kCamera.width, kCamera.height, 1.0f);
  for (int v = 0; v < depth.height(); ++v) {
    for (int u = 160; u < depth.width(); ++u) depth(u, v) = 1.6f;
  }
  const SourceCloud cloud = sample(depth, SamplingConfig{});
  ASSERT_GT(cloud.points.size(), 800u);
  for (const SourcePoint& p : cloud.points) {
    EXPECT_NEAR(p.point.z(), p.u < 160 ? 1.0f : 1.6f, 1e-3f);
    EXPECT_LT(angle_deg(p.normal, {0, 0, -1}), 0.2);
  }
}

TEST(PlaneFitSampler, DropsMissingFarNearAndFlatSurfaces) {
  SamplingConfig config;
  EXPECT_TRUE(sample(DepthImage(kCamera.width, kCamera.height), config).points.empty());
  EXPECT_TRUE(sample(DepthImage(kCamera.width, kCamera.height, 4.6f), config).points.empty());
  EXPECT_TRUE(sample(DepthImage(kCamera.width, kCamera.height, 0.05f), config).points.empty());
  // A floor 2 cm below the optical axis is seen at more than 80 degrees all over.
  config.max_depth_m = 10;
  for (const SourcePoint& p : sample(plane_depth({0, -1, 0}, -0.02), config).points) {
    const double cosine = -static_cast<double>(p.normal.dot(p.point.normalized()));
    EXPECT_GT(cosine, std::cos(80 * std::numbers::pi / 180));
  }
}

TEST(PlaneFitSampler, SmoothDepthFollowsThePlaneAtEveryPixel) {
  const Eigen::Vector3d n = Eigen::Vector3d(0.5, -0.3, -1).normalized();
  const DepthImage depth = plane_depth(n, -2);
  const auto sampler = make_sampler(SamplingConfig{}, kCamera, false);
  SourceCloud cloud;
  sampler->sample(depth, cloud);
  for (int v = 21; v < 220; v += 13) {
    for (int u = 20; u < 300; u += 11) {
      EXPECT_NEAR(1 / sampler->inverse_depth_plane(u, v).q, depth(u, v), 1e-3f);
    }
  }
}

TEST(PlaneFitSampler, EllipsesArePlanarAndOnlyMadeOnDemand) {
  const Eigen::Vector3d n = Eigen::Vector3d(0.2, 0.2, -1).normalized();
  const DepthImage depth = plane_depth(n, -1.5);
  EXPECT_TRUE(sample(depth, SamplingConfig{}, false).covariances.empty());
  const SourceCloud cloud = sample(depth, SamplingConfig{}, true);
  ASSERT_EQ(cloud.covariances.size(), cloud.points.size());
  const Eigen::Vector3f nf = n.cast<float>();
  for (const Eigen::Matrix3f& C : cloud.covariances) {
    EXPECT_NEAR(nf.dot(C * nf), 1e-3f, 1e-4f);
    EXPECT_NEAR(C.trace(), 2.001f, 1e-4f);
  }
}

SamplingConfig neighbours() {
  SamplingConfig config;
  config.method = SamplingMethod::kNeighbours;
  config.step_px = 5;
  config.min_depth_m = 0.01;
  return config;
}

TEST(NeighbourSampler, PlaneGivesAFlatNormalisedEllipse) {
  const Eigen::Vector3d n = Eigen::Vector3d(0.3, 0.2, -1).normalized();
  const SourceCloud cloud = sample(plane_depth(n, -1.5), neighbours());
  ASSERT_GT(cloud.points.size(), 2500u);
  ASSERT_EQ(cloud.covariances.size(), cloud.points.size());
  const Eigen::Vector3f nf = n.cast<float>();
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    EXPECT_LT(angle_deg(cloud.points[i].normal, n), 0.2);
    EXPECT_NEAR(nf.dot(cloud.covariances[i] * nf), 1e-3f, 1e-4f);  // the floor
    // Eigenvalues a >= 1 >= floor: the middle one is exactly 1.
    EXPECT_GE(cloud.covariances[i].trace(), 2.0f);
  }
}

TEST(NeighbourSampler, NeighboursAreTheTenNearestOfTheWholeCloud) {
  // Inside the image of a bent surface the 5x5 window holds the ten nearest of all points.
  DepthImage depth(kCamera.width, kCamera.height);
  for (int v = 0; v < depth.height(); ++v) {
    for (int u = 0; u < depth.width(); ++u) {
      depth(u, v) = 1.5f + 0.1f * std::sin(static_cast<float>(u) * 0.02f) *
                               std::cos(static_cast<float>(v) * 0.03f);
    }
  }
  const SourceCloud cloud = sample(depth, neighbours());
  for (std::size_t i = 0; i < cloud.points.size(); i += 97) {
    std::vector<std::pair<float, std::size_t>> order;
    for (std::size_t j = 0; j < cloud.points.size(); ++j) {
      order.emplace_back((cloud.points[j].point - cloud.points[i].point).squaredNorm(), j);
    }
    std::sort(order.begin(), order.end());
    if (order[10].first < order[9].first * 1.001f) continue;  // a tie may go either way
    const SourcePoint& p = cloud.points[i];
    if (p.u < 20 || p.v < 20 || p.u > 300 || p.v > 220) continue;  // clipped window
    Eigen::Matrix3d S = Eigen::Matrix3d::Zero();
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (int k = 0; k < 10; ++k) {
      mean += cloud.points[order[static_cast<std::size_t>(k)].second].point.cast<double>() / 10;
    }
    for (int k = 0; k < 10; ++k) {
      const Eigen::Vector3d x =
          cloud.points[order[static_cast<std::size_t>(k)].second].point.cast<double>() - mean;
      S += x * x.transpose() / 10;
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(S);
    const Eigen::Vector3d values = (eigen.eigenvalues() / eigen.eigenvalues()[1]).cwiseMax(1e-3);
    EXPECT_NEAR(cloud.covariances[i].trace(), values.sum(), 2e-2 * values.sum());
  }
}

TEST(Samplers, RejectAnImageOfAnotherSize) {
  SourceCloud cloud;
  EXPECT_THROW(make_sampler(SamplingConfig{}, kCamera, false)->sample(DepthImage(10, 10), cloud),
               ContractViolation);
  EXPECT_THROW(make_sampler(neighbours(), kCamera, true)->sample(DepthImage(10, 10), cloud),
               ContractViolation);
}

}  // namespace
}  // namespace sgs::registration
