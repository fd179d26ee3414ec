// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/eval/trajectory_metrics.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace sgs::eval {
namespace {

using ::testing::DoubleNear;

SE3 at_point(double x, double y, double z) {
  return {Eigen::Matrix3d::Identity(), Eigen::Vector3d(x, y, z)};
}

Trajectory make(const std::vector<SE3>& poses, double rate_hz = 10, double start_s = 0) {
  Trajectory t;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    t.push_back({start_s + static_cast<double>(i) / rate_hz, poses[i]});
  }
  return t;
}

/// Truth in the plane z = 0, symmetric about both axes, so that errors along z that sum to zero
/// over each symmetric group leave the alignment at the identity.
std::vector<SE3> cross() {
  return {at_point(1, 0, 0), at_point(-1, 0, 0), at_point(0, 1, 0), at_point(0, -1, 0),
          at_point(2, 0, 0), at_point(-2, 0, 0), at_point(0, 2, 0), at_point(0, -2, 0)};
}

std::vector<SE3> line(int n, double step_m) {
  std::vector<SE3> poses;
  for (int i = 0; i < n; ++i) poses.push_back(at_point(i * step_m, 0, 0));
  return poses;
}

TEST(Ate, KnownErrors) {
  const double d = 0.01;
  const double dz[] = {3 * d, 3 * d, -3 * d, -3 * d, d, d, -d, -d};
  std::vector<SE3> moved = cross();
  for (std::size_t i = 0; i < moved.size(); ++i) moved[i].t.z() = dz[i];
  const auto m = evaluate_trajectory(to_estimates(make(moved)), make(cross()));
  ASSERT_TRUE(m.ate);
  EXPECT_NEAR(m.ate->rmse, std::sqrt(5.0) * d, 1e-12);
  EXPECT_NEAR(m.ate->mean, 2 * d, 1e-12);
  EXPECT_NEAR(m.ate->median, 2 * d, 1e-12);
  EXPECT_NEAR(m.ate->stddev, d, 1e-12);
  EXPECT_NEAR(m.ate->min, d, 1e-12);
  EXPECT_NEAR(m.ate->max, 3 * d, 1e-12);
  ASSERT_EQ(m.errors.size(), 8u);
  EXPECT_NEAR(m.errors[4].error_m, d, 1e-12);
  EXPECT_DOUBLE_EQ(*m.tracked_percent, 100);
}

TEST(Ate, RigidMotionOfTheWholeTrajectoryCostsNothing) {
  Vector6d xi;
  xi << 0.3, -0.8, 1.1, 5, -2, 7;
  const SE3 T = SE3::exp(xi);
  std::vector<SE3> moved;
  for (const SE3& pose : cross()) moved.push_back(T * pose);
  const auto m = evaluate_trajectory(to_estimates(make(moved)), make(cross()));
  EXPECT_NEAR(m.ate->max, 0, 1e-12);
  EXPECT_NEAR(m.rpe_frame->translation_rmse_m, 0, 1e-12);
  EXPECT_NEAR(m.rpe_frame->rotation_rmse_deg, 0, 1e-5);
  EXPECT_NEAR((*m.T_truth_world * T).log().norm(), 0, 1e-9);
}

TEST(Ate, ScaleIsReportedButNotApplied) {
  std::vector<SE3> half = cross();
  for (SE3& pose : half) pose.t *= 0.5;
  const auto m = evaluate_trajectory(to_estimates(make(half)), make(cross()));
  EXPECT_NEAR(*m.scale, 2, 1e-12);
  EXPECT_NEAR(m.ate->mean, 0.75, 1e-12);  // half of 1 and of 2
}

TEST(Ate, OutlierIsNotTracked) {
  // 100 frames on a line, one of them 50 m off sideways: alignment hardly moves the others.
  std::vector<SE3> moved = line(100, 0.1);
  moved[50].t.z() = 50;
  TrajectoryOptions options;
  options.frames_total = 200;
  const auto m = evaluate_trajectory(to_estimates(make(moved)), make(line(100, 0.1)), options);
  EXPECT_EQ(m.frames_total, 200);
  EXPECT_NEAR(m.errors[50].error_m, 49.5, 0.1);  // 50 less the shift of the mean
  EXPECT_DOUBLE_EQ(*m.tracked_percent, 49.5);    // 99 of 200
}

TEST(Association, InterpolatesBetweenTruePoses) {
  std::vector<PoseEstimate> estimates;
  for (int i = 0; i < 9; ++i)
    estimates.push_back({i, 0.05 + 0.1 * i, at_point(0.05 + 0.1 * i, 0, 0)});
  const Trajectory truth = make(line(10, 0.1));
  const auto m = evaluate_trajectory(estimates, truth);
  EXPECT_EQ(m.interpolated, 9u);
  EXPECT_NEAR(m.ate->max, 0, 1e-12);
  TrajectoryOptions nearest;
  nearest.association = Association::kNearest;
  const auto none = evaluate_trajectory(estimates, truth, nearest);
  EXPECT_EQ(none.paired, 0u);
  EXPECT_EQ(none.dropped, 9u);
  EXPECT_FALSE(none.ate);
  EXPECT_FALSE(none.note.empty());
}

TEST(Association, GapOfTruthIsNotBridged) {
  std::vector<StampedPose> poses;
  for (int i = 0; i < 10; ++i) {
    if (i != 5 && i != 6) poses.push_back({0.1 * i, at_point(i, 0, 0)});
  }
  std::vector<PoseEstimate> estimates = to_estimates(make(line(10, 1)));
  estimates[4].timestamp_s += 0.015;  // inside the gap, near its first end
  const Pairing p = associate(estimates, Trajectory(poses), {});
  EXPECT_EQ(p.unmatched, 2u);
  EXPECT_EQ(p.pairs.size(), 8u);
  EXPECT_EQ(p.interpolated, 7u);  // the moved one takes the nearest pose instead
}

TEST(Association, NearestIsOneToOne) {
  std::vector<PoseEstimate> estimates = {{0, 1.000, at_point(0, 0, 0)},
                                         {1, 1.010, at_point(1, 0, 0)}};
  Trajectory truth;
  truth.push_back({1.012, at_point(0, 0, 0)});
  TrajectoryOptions options;
  options.association = Association::kNearest;
  const Pairing p = associate(estimates, truth, options);
  ASSERT_EQ(p.pairs.size(), 1u);
  EXPECT_EQ(p.pairs[0].estimate, 1u);
  EXPECT_EQ(p.unmatched, 1u);
}

TEST(Association, NiceSlamThinsTo32Hz) {
  TrajectoryOptions options;
  options.association = Association::kNiceSlam;
  const auto estimates = to_estimates(make(line(100, 0.01), 100, 0.07));
  const Trajectory truth = make(line(100, 0.01), 100);
  const Pairing p = associate(estimates, truth, options);
  EXPECT_EQ(p.pairs.size(), 25u);
  EXPECT_EQ(p.thinned, 75u);
  EXPECT_EQ(p.unmatched, 0u);
}

TEST(Rpe, ScaledMotion) {
  const auto m = evaluate_trajectory(to_estimates(make(line(31, 0.11))), make(line(31, 0.1)));
  EXPECT_NEAR(m.rpe_frame->translation_rmse_m, 0.01, 1e-12);
  EXPECT_EQ(m.rpe_frame->pairs, 30u);
  EXPECT_NEAR(m.rpe_1s->translation_rmse_m, 0.1, 1e-12);
  EXPECT_EQ(m.rpe_1s->pairs, 21u);
}

TEST(Rpe, TurningOneDegreePerFrame) {
  std::vector<SE3> turning;
  for (int i = 0; i < 21; ++i) {
    turning.emplace_back(so3_exp(Eigen::Vector3d(0, i * std::numbers::pi / 180, 0)),
                         Eigen::Vector3d::Zero());
  }
  const std::vector<SE3> still(21);
  const auto m = evaluate_trajectory(to_estimates(make(turning)), make(still));
  EXPECT_NEAR(m.rpe_frame->rotation_rmse_deg, 1, 1e-9);
  EXPECT_NEAR(m.rpe_1s->rotation_rmse_deg, 10, 1e-9);
  EXPECT_NEAR(m.rpe_1s->translation_rmse_m, 0, 1e-12);
  EXPECT_FALSE(m.scale);
}

// What it seems to have moved by is error, and the truth over it no scale.
TEST(Scale, ACameraThatStoodStillHasNone) {
  std::vector<SE3> trembling;
  for (int i = 0; i < 21; ++i) {
    trembling.emplace_back(Eigen::Matrix3d::Identity(), Eigen::Vector3d(1e-3 * (i % 3), 0, 0));
  }
  std::vector<SE3> still(21);
  for (int i = 0; i < 21; ++i) still[static_cast<std::size_t>(i)].t.x() = 1e-12 * i;
  const auto m = evaluate_trajectory(to_estimates(make(trembling)), make(still));
  ASSERT_TRUE(m.ate);
  EXPECT_FALSE(m.scale);
}

TEST(Rpe, MissingFramesMakeNoFramePairs) {
  auto estimates = to_estimates(make(line(5, 0.1)));
  estimates.erase(estimates.begin() + 2);
  const auto m = evaluate_trajectory(estimates, make(line(5, 0.1)));
  EXPECT_EQ(m.rpe_frame->pairs, 2u);  // 0-1 and 3-4
}

TEST(Degenerate, FewPosesGiveEmptyValues) {
  const Trajectory truth = make(line(50, 0.1));
  for (int n = 0; n < 3; ++n) {
    const auto m = evaluate_trajectory(to_estimates(make(line(n, 0.1))), truth);
    EXPECT_FALSE(m.ate) << n;
    EXPECT_FALSE(m.scale) << n;
    EXPECT_FALSE(m.tracked_percent) << n;
    EXPECT_EQ(m.rpe_frame.has_value(), n == 2) << n;
    EXPECT_FALSE(m.rpe_1s) << n;
    EXPECT_FALSE(m.note.empty()) << n;
  }
  const auto apart = evaluate_trajectory(to_estimates(make(line(50, 0.1), 10, 1e6)), truth);
  EXPECT_FALSE(apart.ate);
  EXPECT_EQ(apart.dropped, 50u);
  EXPECT_EQ(evaluate_trajectory(to_estimates(truth), Trajectory()).note, "no ground truth");
}

TEST(Degenerate, NonFinitePosesAreDroppedAndLostOnesCounted) {
  auto estimates = to_estimates(make(cross()));
  estimates[1].T_world_camera.t.x() = std::numeric_limits<double>::quiet_NaN();
  estimates[2].lost = true;
  const auto m = evaluate_trajectory(estimates, make(cross()));
  EXPECT_EQ(m.paired, 7u);
  EXPECT_EQ(m.dropped, 1u);
  EXPECT_EQ(m.lost, 1u);
  EXPECT_THAT(m.ate->rmse, DoubleNear(0, 1e-12));
  EXPECT_DOUBLE_EQ(*m.tracked_percent, 87.5);
}

TEST(Association, NamesRoundTrip) {
  EXPECT_EQ(*parse_association("nice-slam"), Association::kNiceSlam);
  EXPECT_FALSE(parse_association("nicest"));
}

TEST(TrajectoryMetrics, ScaleErrorSaysHowMuchLargerTheEstimateIs) {
  std::vector<StampedPose> truth;
  std::vector<PoseEstimate> estimates;
  for (int i = 0; i < 20; ++i) {
    const Eigen::Vector3d at(0.1 * i, std::sin(0.3 * i), 0);
    const double t = 0.1 * i;
    truth.push_back({t, SE3(Eigen::Matrix3d::Identity(), at)});
    estimates.push_back({i, t, SE3(Eigen::Matrix3d::Identity(), 1.02 * at), false});
  }
  const auto m = evaluate_trajectory(estimates, Trajectory(truth));
  ASSERT_TRUE(m.scores.scale_error_percent);
  EXPECT_NEAR(*m.scores.scale_error_percent, 2, 1e-9);
}

}  // namespace
}  // namespace sgs::eval
