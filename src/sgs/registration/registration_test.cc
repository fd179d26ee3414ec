// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <random>

#include "sgs/registration/geometric_cost.h"
#include "sgs/registration/pose_solver.h"

namespace sgs::registration {
namespace {

const PinholeCamera kSolverCamera{320, 240, 270, 268, 159.3, 121.1};

// A corner of three walls as seen from the origin, on a pixel grid; planes n.p = d.
SourceCloud corner(int step, float jitter = 0) {
  const Eigen::Vector3f normals[3] = {Eigen::Vector3f(-0.8f, 0.1f, -0.6f).normalized(),
                                      Eigen::Vector3f(0.7f, 0.2f, -0.7f).normalized(),
                                      Eigen::Vector3f(0.0f, -0.9f, -0.45f).normalized()};
  const float distances[3] = {-1.3f, -1.2f, -1.1f};
  std::mt19937_64 engine{3};
  SourceCloud cloud;
  for (int v = step / 2; v < kSolverCamera.height; v += step) {
    for (int u = step / 2; u < kSolverCamera.width; u += step) {
      const Eigen::Vector3f ray = kSolverCamera.back_project(u, v, 1.0).cast<float>();
      SourcePoint best;
      float z = 4;
      for (int k = 0; k < 3; ++k) {
        const float hit = distances[k] / normals[k].dot(ray);
        if (hit > 0.2f && hit < z) {
          z = hit;
          best.normal = normals[k];
        }
      }
      if (z >= 4) continue;
      const float noise = jitter * (static_cast<float>(engine() >> 11) * 0x1.0p-53f - 0.5f);
      best.point = (z + noise) * ray;
      best.variance_m2 = 1e-6f;
      cloud.points.push_back(best);
      cloud.covariances.push_back(plane_ellipse(best.normal, 1e-3f));
    }
  }
  return cloud;
}

TargetCloud as_targets(const SourceCloud& source, const SE3& T_local_camera) {
  const Eigen::Matrix3f R = T_local_camera.R.cast<float>();
  TargetCloud cloud;
  for (std::size_t i = 0; i < source.points.size(); ++i) {
    const SourcePoint& p = source.points[i];
    cloud.points.push_back({(T_local_camera * p.point.cast<double>().eval()).cast<float>(),
                            R * p.normal, p.variance_m2});
    cloud.covariances.push_back(R * source.covariances[i] * R.transpose());
  }
  return cloud;
}

struct Method {
  SearchMethod search;
  FactorType factor;
  SolverMethod solver;
};

class RegistrationTest : public testing::TestWithParam<Method> {
 protected:
  SE3 register_from(const SourceCloud& source, const TargetCloud& targets, const SE3& T_start,
                    PoseSolution* details = nullptr) {
    SearchConfig search_config;
    search_config.method = GetParam().search;
    search_config.max_distance_m = 0.15;
    FactorConfig factor_config;
    factor_config.type = GetParam().factor;
    factor_config.reject = 1e9;
    SolverConfig solver_config;
    solver_config.method = GetParam().solver;
    solver_config.max_iterations = 40;
    solver_config.stop_rad = solver_config.stop_m = 1e-5;
    const auto search = make_search(search_config, kSolverCamera);
    GeometricCost cost(factor_config);
    search->prepare(targets, T_start);
    const SE3 T_reference_local = search->T_local_reference().inverse();
    const PoseSolution s = solve_pose(
        solver_config,
        {[&](const SE3& T) { return cost.linearize(source, *search, T_reference_local * T); },
         [&](const SE3& T) { return cost.error(source, *search, T_reference_local * T); }},
        T_start);
    if (details) *details = s;
    return s.T;
  }
};

Vector6d three_cm_three_degrees() {
  Vector6d xi;
  xi << 0.03, -0.035, 0.02, 0.02, -0.015, 0.018;
  return xi;
}

TEST_P(RegistrationTest, CornerConvergesBelowAMillimetre) {
  const SE3 T_truth(so3_exp({0.2, 0.4, -0.1}), {0.4, -0.8, 1.1});
  const TargetCloud targets = as_targets(corner(4, 0.002f), T_truth);
  PoseSolution s;
  const SE3 T = register_from(corner(8), targets, T_truth * SE3::exp(three_cm_three_degrees()), &s);
  EXPECT_LT((T.t - T_truth.t).norm(), 1e-3);
  EXPECT_LT((T_truth.inverse() * T).angle(), 1e-3);
  EXPECT_GT(s.last.inliers, 800);
}

TEST_P(RegistrationTest, ResidualVanishesAtTruth) {
  const SourceCloud source = corner(8);
  const SE3 T_truth(so3_exp({0.2, 0.4, -0.1}), {0.4, -0.8, 1.1});
  PoseSolution s;
  const SE3 T = register_from(source, as_targets(source, T_truth), T_truth, &s);
  EXPECT_LT((T.t - T_truth.t).norm(), 1e-6);
  EXPECT_LT(s.last.error / s.last.inliers, 1e-4);
}

TEST_P(RegistrationTest, MovingTheWorldByAHundredMetresChangesNothing) {
  const SE3 T_truth(so3_exp({0.2, 0.4, -0.1}), {0.4, -0.8, 1.1});
  const SE3 shift(Eigen::Matrix3d::Identity(), {100, -60, 30});
  const SourceCloud source = corner(8);
  const SourceCloud model = corner(4, 0.002f);
  const SE3 T_start = T_truth * SE3::exp(three_cm_three_degrees());
  PoseSolution near, far;
  const SE3 T_near = register_from(source, as_targets(model, T_truth), T_start, &near);
  const SE3 T_far =
      register_from(source, as_targets(model, shift * T_truth), shift * T_start, &far);
  EXPECT_LT((T_far.t - shift.t - T_near.t).norm(), 1e-4);  // float holds 8 um at 100 m
  // The Hessian lives in the camera frame: the same spectrum, not one inflated by the lever arm.
  EXPECT_LT((near.last.H - far.last.H).norm(), 0.01 * near.last.H.norm());
}

INSTANTIATE_TEST_SUITE_P(
    Presets, RegistrationTest,
    testing::Values(
        Method{SearchMethod::kProjective, FactorType::kPlane, SolverMethod::kGaussNewton},
        Method{SearchMethod::kNearest, FactorType::kPlane, SolverMethod::kLevenbergMarquardt},
        Method{SearchMethod::kNearest, FactorType::kGicp, SolverMethod::kLevenbergMarquardt},
        Method{SearchMethod::kProjective, FactorType::kGicp, SolverMethod::kGaussNewton}),
    [](const auto& param_info) {
      return to_string(param_info.param.search) + "_" + to_string(param_info.param.factor) + "_" +
             to_string(param_info.param.solver);
    });

TEST(PoseSolver, StepsAreCappedAndBadSystemsGiveNone) {
  Linearization system;
  system.H.setIdentity();
  system.b << 3, 0, 0, 0, 0, 0.2;
  SolverConfig config;
  const Vector6d xi = damped_step(system, 0, config);
  EXPECT_NEAR(xi.head<3>().norm(), config.max_step_rad, 1e-12);
  EXPECT_LE(xi.tail<3>().norm(), config.max_step_m);
  EXPECT_LT(xi[5], 0);
  system.H.setConstant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(damped_step(system, 0, config), Vector6d::Zero());
}

TEST(PoseSolver, LevenbergMarquardtNeverRaisesTheCost) {
  // A valley that Gauss-Newton overshoots: cost = sqrt-like in one translation.
  SolverConfig config;
  config.method = SolverMethod::kLevenbergMarquardt;
  config.max_step_m = 1;
  config.max_iterations = 30;
  const auto cost = [](const SE3& T) { return std::abs(T.t.x() - 0.5) + T.t.squaredNorm() * 1e-3; };
  double last = std::numeric_limits<double>::infinity();
  solve_pose(config,
             {[&](const SE3& T) {
                EXPECT_LE(cost(T), last);
                last = cost(T);
                Linearization lin;
                lin.H.setIdentity();
                lin.H *= 0.5;  // too flat a model
                lin.b[3] = T.t.x() > 0.5 ? 0.5 : -0.5;
                lin.error = cost(T);
                lin.inliers = 1;
                return lin;
              },
              cost},
             SE3{});
  EXPECT_LT(last, 0.2);
}

TEST(GeometricCost, RelinearizingKeepsTheMatches) {
  const SourceCloud source = corner(8);
  const auto search = make_search(SearchConfig{}, kSolverCamera);
  search->prepare(as_targets(corner(4, 0.002f), SE3{}), SE3{});
  GeometricCost cost(FactorConfig{});
  const Linearization first = cost.linearize(source, *search, SE3{});
  const auto matches = cost.matches();
  EXPECT_EQ(cost.relinearize(source, *search, SE3{}).H, first.H);
  const SE3 away(Eigen::Matrix3d::Identity(), {0.004, 0.003, -0.002});
  const Linearization there = cost.relinearize(source, *search, away);
  EXPECT_EQ(cost.matches(), matches);
  EXPECT_NEAR(there.error, cost.error(source, *search, away), 1e-3 * there.error);
  EXPECT_GT(there.error, first.error);
}

TEST(GeometricCost, OverlapCountsNearMatchesOnly) {
  const SourceCloud source = corner(8);
  const auto search = make_search(SearchConfig{}, kSolverCamera);
  const TargetCloud targets = as_targets(source, SE3{});
  search->prepare(targets, SE3{});
  GeometricCost cost(FactorConfig{});
  cost.linearize(source, *search, SE3{});
  EXPECT_GT(cost.overlap(source, *search, SE3{}, 0.03), 0.95);
  const SE3 away(Eigen::Matrix3d::Identity(), {0, 0, 1});
  cost.linearize(source, *search, away);
  EXPECT_LT(cost.overlap(source, *search, away, 0.03), 0.1);
}

}  // namespace
}  // namespace sgs::registration
