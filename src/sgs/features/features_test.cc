// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>
#include <utility>

#include "sgs/features/visual_map.h"

namespace sgs::features {
namespace {

const PinholeCamera kCamera{480, 360, 400, 400, 239.5, 179.5};

std::uint32_t hash(std::int64_t x, std::int64_t y) {
  std::uint64_t h = static_cast<std::uint64_t>(x) * 0x9e3779b97f4a7c15ULL ^
                    static_cast<std::uint64_t>(y) * 0xc2b2ae3d27d4eb4fULL;
  h ^= h >> 29;
  h *= 0xbf58476d1ce4e5b9ULL;
  return static_cast<std::uint32_t>(h >> 40);
}

// Random tiles on two slanted walls that meet, seen from `T`; `contrast` 1 = full.
RgbdFrame render(const SE3& T, double contrast = 1) {
  RgbdFrame frame;
  frame.camera = kCamera;
  frame.color = ColorImage(kCamera.width, kCamera.height);
  frame.depth = DepthImage(kCamera.width, kCamera.height);
  for (int v = 0; v < kCamera.height; ++v) {
    for (int u = 0; u < kCamera.width; ++u) {
      const Eigen::Vector3d ray = T.R * kCamera.back_project(u, v, 1);
      double z = 1e9;
      for (double side : {-1.0, 1.0}) {  // z + side * 0.4 x = 2.2, the nearer one
        const Eigen::Vector3d n(side * 0.4, 0, 1);
        const double d = (2.2 - n.dot(T.t)) / n.dot(ray);
        if (d > 0) z = std::min(z, d);
      }
      const Eigen::Vector3d p = T.t + z * ray;
      const auto tile = [](double a) { return static_cast<std::int64_t>(std::floor(a / 0.06)); };
      const double value = 128 + contrast * (hash(tile(p.x()), tile(p.y())) % 200 - 100.0);
      const auto g = static_cast<std::uint8_t>(value);
      frame.color(u, v) = {g, g, g};
      frame.depth(u, v) = static_cast<float>(z);
    }
  }
  return frame;
}

SE3 pose(double rx, double ry, double rz, double x, double y, double z) {
  Vector6d xi;
  xi << rx, ry, rz, x, y, z;
  return SE3::exp(xi);
}

void expect_near(const SE3& a, const SE3& b, double metres, double radians) {
  const SE3 e = a.inverse() * b;
  EXPECT_LT(e.t.norm(), metres);
  EXPECT_LT(e.angle(), radians);
}

TEST(Orb, FindsFeaturesWithDepthAndRepeats) {
  const RgbdFrame frame = render({});
  OrbExtractor a({}), b({});
  const OrbFrame x = a.extract(frame), y = b.extract(frame);
  ASSERT_GT(x.keypoints.size(), 500U);
  ASSERT_EQ(x.keypoints.size(), y.keypoints.size());
  EXPECT_EQ(cv::norm(x.descriptors, y.descriptors, cv::NORM_HAMMING), 0);
  EXPECT_GT(x.keypoints[0].depth_m, 1);
  for (const Match& m : match_cross_check(x, y)) EXPECT_EQ(m.distance, 0);
}

// Few bits are set, so that many distances are the same.
cv::Mat descriptors(int rows, int step) {
  cv::Mat out(rows, 32, CV_8U, cv::Scalar(0));
  for (int i = 0; i < rows; ++i) {
    for (int k = 0; k < 6; ++k) {
      const int bit = (step * i * i + 7 * k * i + 13 * k) % 24;
      out.at<std::uint8_t>(i, (11 * bit) % 32) |= static_cast<std::uint8_t>(1 << bit % 8);
    }
  }
  return out;
}

TEST(Orb, MatchesAsOpenCvDoes) {
  for (const auto& [rows, columns] : {std::pair(60, 45), std::pair(45, 60), std::pair(1, 3)}) {
    OrbFrame a, b;
    a.descriptors = descriptors(rows, 3);
    b.descriptors = descriptors(columns, 5);
    std::vector<cv::DMatch> expected;
    cv::BFMatcher(cv::NORM_HAMMING, true).match(a.descriptors, b.descriptors, expected);
    const auto matches = match_cross_check(a, b);
    ASSERT_EQ(matches.size(), expected.size());
    for (std::size_t i = 0; i < matches.size(); ++i) {
      EXPECT_EQ(matches[i].a, expected[i].queryIdx);
      EXPECT_EQ(matches[i].b, expected[i].trainIdx);
      EXPECT_EQ(matches[i].distance, static_cast<int>(expected[i].distance));
      EXPECT_EQ(matches[i].distance, hamming(a.descriptors.ptr<std::uint8_t>(matches[i].a),
                                             b.descriptors.ptr<std::uint8_t>(matches[i].b)));
    }
  }
}

TEST(Orb, EqualisesAfterAPoorFrame) {
  OrbExtractor orb({});
  RgbdFrame blank = render({}, 0);
  EXPECT_TRUE(orb.extract(blank).keypoints.empty());
  const OrbFrame faint = orb.extract(render({}, 0.08));
  EXPECT_TRUE(faint.equalised);
  OrbExtractor plain({});
  EXPECT_GT(faint.keypoints.size(), plain.extract(render({}, 0.08)).keypoints.size());
}

std::vector<Observation> exact_observations(const SE3& T) {
  std::vector<Observation> out;
  for (int i = 0; i < 80; ++i) {
    const Eigen::Vector3d p(-0.8 + 0.02 * i, 0.7 * std::sin(1.7 * i), 2 + std::cos(2.3 * i));
    out.push_back({T * p, kCamera.project(p), 1 + 0.02 * i, p.z(), 0.01});
  }
  return out;
}

TEST(Refine, GradientMatchesNumericalDerivative) {
  const auto o = exact_observations({});
  const SE3 T = pose(0.004, -0.002, 0.003, 0.006, 0.004, -0.005);
  for (double huber : {1.0, 1e9}) {
    const auto l = linearize(o, kCamera, T, huber);
    for (int k = 0; k < 6; ++k) {
      const double h = 1e-6;
      const Vector6d e = h * Vector6d::Unit(k);
      const double numeric = (linearize(o, kCamera, T * SE3::exp(e), huber).cost -
                              linearize(o, kCamera, T * SE3::exp(-e), huber).cost) /
                             (2 * h);
      EXPECT_NEAR(l.b(k), numeric, 1e-4 * (1 + l.b.norm()));
    }
  }
}

TEST(Refine, ReachesTruthDespiteOutliersAndFarFromTheOrigin) {
  const SE3 truth(Eigen::Matrix3d::Identity(), Eigen::Vector3d(100, -30, 40));
  auto o = exact_observations(truth);
  for (std::size_t i = 0; i < o.size(); i += 8) o[i].uv += Eigen::Vector2d(40, -25);
  const VisualPose r = refine(o, kCamera, truth * pose(0.01, 0.02, -0.01, 0.03, -0.02, 0.03), {});
  EXPECT_EQ(r.verdict, Verdict::kOk);
  expect_near(truth, r.T_world_camera, 3e-3, 2e-3);
  EXPECT_NEAR(r.inliers, 70, 2);
}

TEST(Pnp, FindsThePoseAndIgnoresTheGlobalGenerator) {
  const SE3 truth = pose(0.1, 0.2, 0, 1, 2, 3);
  auto o = exact_observations(truth);
  for (std::size_t i = 0; i < o.size(); i += 4) o[i].uv += Eigen::Vector2d(60, 35);
  cv::setRNGSeed(1);
  const PnpResult a = pnp_ransac(o, kCamera, {});
  cv::setRNGSeed(99);
  cv::theRNG().next();
  const PnpResult b = pnp_ransac(o, kCamera, {});
  EXPECT_EQ(a.inliers.size(), 60U);
  EXPECT_EQ(a.inliers, b.inliers);
  EXPECT_EQ((a.T_world_camera.t - b.T_world_camera.t).norm(), 0);
  expect_near(truth, a.T_world_camera, 1e-3, 1e-3);
}

TEST(FramePrior, MeasuresTheMotionAndRejectsTheImplausible) {
  OrbExtractor orb({});
  const SE3 T0 = pose(0, 0, 0, 0.1, 0, 0), T1 = T0 * pose(0.01, -0.015, 0.01, 0.02, 0.01, -0.02);
  const OrbFrame a = orb.extract(render(T0)), b = orb.extract(render(T1));
  const VisualPose p = frame_to_frame_prior(a, T0, b, {});
  ASSERT_EQ(p.verdict, Verdict::kOk) << to_string(p.verdict);
  // Unweighted pixels of all octaves: the weakness of this prior, here a third of the motion.
  expect_near(T1, p.T_world_camera, 0.02, 0.01);
  EXPECT_GT(p.information.diagonal().minCoeff(), 1e3);
  VisualPoseConfig strict;
  strict.max_translation_m = 0.005;
  const VisualPose refused = frame_to_frame_prior(a, T0, b, strict);
  EXPECT_EQ(refused.verdict, Verdict::kImplausibleMotion);
  expect_near(T0, refused.T_world_camera, 1e-12, 1e-6);
  const OrbFrame blank = orb.extract(render(T0, 0));
  EXPECT_EQ(frame_to_frame_prior(a, T0, blank, {}).verdict, Verdict::kTooFewMatches);
}

TEST(VisualMap, LocalisesAroundAPredictionAndRelocalisesWithoutOne) {
  OrbExtractor orb({});
  VisualMap map({});
  const SE3 K0, K1 = pose(0, 0.05, 0, 0.15, 0, 0), K2 = pose(0, 0, 0, -0.6, 0.3, 0);
  for (const SE3& T : {K2, K0, K1}) map.insert(orb.extract(render(T)), T);
  const SE3 truth = pose(0.02, 0.03, -0.02, 0.08, 0.03, 0.04);
  const OrbFrame current = orb.extract(render(truth));
  const VisualPose l = map.localise(current, truth * pose(0.01, 0, 0.01, 0.02, -0.02, 0.01));
  ASSERT_EQ(l.verdict, Verdict::kOk);
  expect_near(truth, l.T_world_camera, 5e-3, 2e-3);
  const VisualPose r = map.relocalise(current);
  ASSERT_EQ(r.verdict, Verdict::kOk) << to_string(r.verdict) << r.matches;
  EXPECT_NE(r.keyframe, 0);
  expect_near(truth, r.T_world_camera, 0.01, 5e-3);
  // A moved world moves with its keyframes.
  const SE3 shift = pose(0.3, 0.2, 0.1, 50, 60, 70);
  map.set_pose(0, shift * K2);
  map.set_pose(1, shift * K0);
  map.set_pose(2, shift * K1);
  expect_near(shift * truth, map.relocalise(current).T_world_camera, 0.01, 5e-3);
}

TEST(VisualMap, SaysSoWhenThereIsNothingToSee) {
  OrbExtractor orb({});
  VisualMap map({});
  const OrbFrame blank = orb.extract(render({}, 0));
  EXPECT_EQ(map.localise(blank, {}).verdict, Verdict::kTooFewMatches);
  map.insert(orb.extract(render({})), {});
  EXPECT_EQ(map.relocalise(blank).verdict, Verdict::kTooFewMatches);
  EXPECT_EQ(map.localise(blank, {}).verdict, Verdict::kTooFewMatches);
  EXPECT_THROW(map.set_pose(3, {}), ContractViolation);
}

TEST(FeaturesConfig, DeclaresItsParameters) {
  OrbConfig orb;
  VisualPoseConfig visual;
  ParameterList list;
  orb.declare(list);
  visual.declare(list);
  EXPECT_TRUE(list.set("features", "512").has_value());
  EXPECT_EQ(orb.features, 512);
  EXPECT_FALSE(list.set("huber", "0").has_value());
}

}  // namespace
}  // namespace sgs::features
