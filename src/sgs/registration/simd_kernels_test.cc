// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// The kernels of every instruction set against plain loops in double.

#include <gtest/gtest.h>
#include <hwy/highway.h>

#include <cmath>
#include <limits>
#include <random>

#include "sgs/registration/cell_match.h"
#include "sgs/registration/photometric_kernel.h"
#include "sgs/registration/plane_window.h"

namespace sgs::registration {
namespace {

class SimdKernels : public ::testing::TestWithParam<std::int64_t> {
 protected:
  void SetUp() override { hwy::SetSupportedTargetsForTest(GetParam()); }
  void TearDown() override { hwy::SetSupportedTargetsForTest(0); }
  float uniform(float low, float high) {
    return low + (high - low) * static_cast<float>(rng_()) / static_cast<float>(rng_.max());
  }

 private:
  std::mt19937_64 rng_{7};
};

std::vector<std::int64_t> targets_of_this_machine() {
  std::vector<std::int64_t> out;
  for (const std::int64_t t : {HWY_AVX3, HWY_AVX2, HWY_SSE4, HWY_NEON, HWY_EMU128, HWY_SCALAR}) {
    if ((hwy::SupportedTargets() & t) != 0) out.push_back(t);
  }
  return out;
}
INSTANTIATE_TEST_SUITE_P(Registration, SimdKernels, ::testing::ValuesIn(targets_of_this_machine()),
                         [](const auto& p) { return std::string(hwy::TargetName(p.param)); });

struct Scene {
  GrayPyramid pyramid;
  DepthImage depth;
  PhotometricView view;
  std::vector<PhotometricPoint> points;
};

// What linearisation means, written down once more: term by term, in double.
PhotometricSums plain_sums(const Scene& scene) {
  const PhotometricView& view = scene.view;
  const auto& image = *view.image;
  const PinholeCamera& camera = image.camera;
  PhotometricSums out;
  for (const PhotometricPoint& point : scene.points) {
    const Eigen::Vector3d middle =
        view.R.cast<double>() * point.p_keyframe.cast<double>() + view.t.cast<double>();
    if (middle.z() <= 0.1) continue;
    const double row = camera.fy * middle.y() / middle.z() + camera.cy;
    const double o = std::clamp((row + 0.5) / camera.height - 0.5, -0.5, 0.5);
    const Eigen::Vector3d X = middle - o * (view.readout.rotation().cast<double>().cross(middle) +
                                            view.readout.translation().cast<double>());
    const Eigen::Vector2d uv = camera.project(X);
    if (uv.x() < 2 || uv.y() < 2 || uv.x() >= camera.width - 3 || uv.y() >= camera.height - 3) {
      continue;
    }
    ++out.visible;
    const double scale = 1 << view.level;
    const double measured = static_cast<double>(scene.depth(
        static_cast<int>((uv.x() + 0.5) * scale), static_cast<int>((uv.y() + 0.5) * scale)));
    const double gate =
        static_cast<double>(view.depth_gate_m) + static_cast<double>(view.depth_gate_ratio) * X.z();
    if (measured > 0 && std::abs(measured - X.z()) > gate) continue;
    ++out.used;
    const GraySample s = image.interpolate(static_cast<float>(uv.x()), static_cast<float>(uv.y()));
    const double gX = static_cast<double>(s.gx) * camera.fx / X.z();
    const double gY = static_cast<double>(s.gy) * camera.fy / X.z();
    const Eigen::Vector3d g(gX, gY, -(gX * X.x() + gY * X.y()) / X.z());
    const double r = static_cast<double>(s.intensity) -
                     static_cast<double>(view.gain) * static_cast<double>(point.intensity) -
                     static_cast<double>(view.offset);
    const double e2 = r * r * static_cast<double>(view.inverse_variance);
    const double nu = static_cast<double>(view.t_dof);
    const double w = (nu + 1) / (nu + e2) * static_cast<double>(view.inverse_variance);
    Eigen::Matrix<double, kPhotometricUnknowns, 1> J;
    J << g.cross(X), -g, o * g.cross(X), -static_cast<double>(point.intensity), -1;
    if (!view.with_readout) J.segment<3>(6).setZero();
    out.H += w * J * J.transpose();
    out.b += w * J * r;
    out.log_sum += std::log1p(e2 / nu);
  }
  return out;
}

TEST_P(SimdKernels, PhotometricSumsMatchPlainLoops) {
  const PinholeCamera camera{160, 120, 130, 128, 80.3, 58.9};
  for (const std::size_t count : {0U, 1U, 15U, 256U, 700U}) {
    for (const int level : {0, 1}) {
      Scene scene;
      Image<float> gray(camera.width, camera.height);
      for (int y = 0; y < camera.height; ++y) {
        for (int x = 0; x < camera.width; ++x) {
          gray(x, y) = 120 + 60 * std::sin(0.11f * static_cast<float>(x)) *
                                 std::cos(0.07f * static_cast<float>(y));
        }
      }
      scene.pyramid.build(gray, camera, 2);
      scene.depth = DepthImage(camera.width, camera.height, 2.0f);
      for (int x = 40; x < 60; ++x) scene.depth(x, 50) = 0;  // unknown: hides nothing
      for (int x = 100; x < 140; ++x) {                      // in front of the points: hides them
        for (int y = 20; y < 90; ++y) scene.depth(x, y) = 1.2f;
      }
      Vector6d motion, readout;
      motion << 0.02, -0.03, 0.01, 0.05, -0.02, 0.03;
      readout << 0.01, -0.02, 0.015, 0.003, 0.002, -0.001;
      const SE3 T = SE3::exp(motion);
      PhotometricView& view = scene.view;
      view.image = &scene.pyramid.level(level);
      view.depth = &scene.depth;
      view.level = level;
      view.R = T.R.cast<float>();
      view.t = T.t.cast<float>();
      view.readout = ReadoutMotion(readout);
      view.gain = 1.1f;
      view.offset = -4;
      view.depth_gate_m = 0.3f;
      view.depth_gate_ratio = 0.05f;
      view.t_dof = 5;
      view.inverse_variance = 1.0f / 64;
      view.with_readout = level == 0;
      for (std::size_t i = 0; i < count; ++i) {
        // Some beyond the borders, some behind the camera.
        const float z = i % 17 == 3 ? -1.0f : uniform(1.8f, 2.2f);
        scene.points.push_back({{uniform(-1.6f, 1.6f), uniform(-1.2f, 1.2f), z}, uniform(40, 200)});
      }
      const PhotometricSums expected = plain_sums(scene);
      const PhotometricSums actual = sum_photometric(view, scene.points);
      EXPECT_EQ(actual.visible, expected.visible);
      EXPECT_EQ(actual.used, expected.used);
      EXPECT_NEAR(actual.log_sum, expected.log_sum, 1e-4 * (1e-3 + expected.log_sum));
      EXPECT_LT((actual.H - expected.H).norm(), 2e-4 * (1e-9 + expected.H.norm())) << count;
      EXPECT_LT((actual.b - expected.b).norm(), 1e-3 * (1e-9 + expected.b.norm())) << count;
      if (count >= 256) {
        EXPECT_GT(expected.used, static_cast<int>(count) / 5);
        EXPECT_LT(expected.used, expected.visible);
        EXPECT_LT(expected.visible, static_cast<int>(count));
      }
    }
  }
}

TEST_P(SimdKernels, WindowSumsMatchPlainLoops) {
  constexpr int kRows = 7, kStride = 12;
  for (const int half : {1, 2, 3}) {
    std::vector<float> image(kRows * kStride, 0.0f);
    for (float& q : image) q = uniform(0, 1) < 0.2f ? 0.0f : uniform(0.4f, 0.6f);
    const Window window{image.data() + 1, kStride, kRows - 1, half, 2, -5};
    const WindowPlane plane{0.003f, -0.002f, 0.5f, 0.06f};
    double n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0, e = 0, xe = 0, ye = 0, ee = 0;
    for (int j = 0; j < window.rows; ++j) {
      for (int i = 0; i <= 2 * half; ++i) {
        const double q = static_cast<double>(window.first[j * kStride + i]);
        const double dx = 2.0 * (i - half), dy = -5.0 + 2 * j;
        const double r =
            q - (static_cast<double>(plane.gamma) + static_cast<double>(plane.alpha) * dx +
                 static_cast<double>(plane.beta) * dy);
        if (!(q > 0) || std::abs(r) > static_cast<double>(plane.gate)) continue;
        n += 1, x += dx, y += dy, xx += dx * dx, xy += dx * dy, yy += dy * dy;
        e += r, xe += r * dx, ye += r * dy, ee += r * r;
      }
    }
    const WindowSums s = sum_window(window, plane);
    ASSERT_GT(n, 3);
    EXPECT_EQ(s.n, static_cast<float>(n));
    EXPECT_NEAR(s.x, x, 1e-3);
    EXPECT_NEAR(s.y, y, 1e-3);
    EXPECT_NEAR(s.xx, xx, 1e-3);
    EXPECT_NEAR(s.xy, xy, 1e-3);
    EXPECT_NEAR(s.yy, yy, 1e-3);
    EXPECT_NEAR(s.e, e, 1e-5);
    EXPECT_NEAR(s.xe, xe, 1e-5);
    EXPECT_NEAR(s.ye, ye, 1e-5);
    EXPECT_NEAR(s.ee, ee, 1e-6);
  }
}

TEST_P(SimdKernels, PointsFallIntoTheCellsOfThePlainProjection) {
  constexpr int kWidth = 22, kHeight = 17;
  constexpr std::size_t kCount = 403;
  const CellCamera camera{30, 30, 11, 8.5f, 0.05f};
  const Eigen::Matrix3f R = Eigen::AngleAxisf(0.2f, Eigen::Vector3f::UnitX()).matrix();
  const Eigen::Vector3f t(0.1f, -0.2f, 0.15f);
  std::vector<float> points[3], normals[3], depths(kCount);
  std::vector<int> cells(kCount);
  for (std::size_t i = 0; i < kCount; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      points[axis].push_back(axis < 2 ? uniform(-1, 1) : uniform(-0.5f, 3));
      normals[axis].push_back(uniform(-1, 0.3f));
    }
  }
  points[0][7] = std::numeric_limits<float>::quiet_NaN();
  for (auto& normal : normals) normal[8] = 0;  // a removed point
  project_to_cells({{points[0].data(), points[1].data(), points[2].data()},
                    {normals[0].data(), normals[1].data(), normals[2].data()},
                    kCount},
                   camera, kWidth, kHeight, R, t, cells.data(), depths.data());
  const Eigen::Vector3f eye = -(R.transpose() * t);
  int inside = 0;
  for (std::size_t i = 0; i < kCount; ++i) {
    const Eigen::Vector3f point(points[0][i], points[1][i], points[2][i]);
    const Eigen::Vector3f normal(normals[0][i], normals[1][i], normals[2][i]);
    const Eigen::Vector3f p = R * point + t;
    const bool facing = normal.dot(point - eye) < 0;
    const int expected = facing ? cell_of(camera, kWidth, kHeight, p) : -1;
    EXPECT_EQ(cells[i], expected) << i;
    if (i != 7) {
      EXPECT_NEAR(depths[i], p.z(), 1e-5);
    }
    inside += expected >= 0 ? 1 : 0;
  }
  EXPECT_GT(inside, 30);
  EXPECT_LT(inside, 180);
}

TEST_P(SimdKernels, CellMatchFindsTheNearestThatAgrees) {
  constexpr int kWidth = 22, kHeight = 17;
  const CellCamera camera{30, 30, 11, 8.5f, 0.05f};
  CellTargets targets(kWidth, kHeight);
  targets.clear();
  std::vector<Eigen::Vector3f> points(kWidth * kHeight), normals(kWidth * kHeight);
  std::vector<bool> filled(kWidth * kHeight, false);
  for (int i = 0; i < 400; ++i) {
    const Eigen::Vector3f p(uniform(-0.7f, 0.7f), uniform(-0.5f, 0.5f), uniform(1.95f, 2.05f));
    const int cell = cell_of(camera, kWidth, kHeight, p);
    if (cell < 0) continue;
    const auto c = static_cast<std::size_t>(cell);
    points[c] = p;
    normals[c] = Eigen::Vector3f(uniform(-1, 1), uniform(-1, 1), -1).normalized();
    filled[c] = true;
    targets.set(cell, points[c], normals[c]);
  }
  std::vector<SourcePoint> sources(500);
  for (SourcePoint& s : sources) {
    s.point = {uniform(-0.8f, 0.8f), uniform(-0.6f, 0.6f), uniform(1.9f, 2.1f)};
    s.normal = Eigen::Vector3f(uniform(-0.5f, 0.5f), uniform(-0.5f, 0.5f), -1).normalized();
  }
  sources[0].point.z() = -1;
  sources[1].point.x() = std::numeric_limits<float>::quiet_NaN();
  const CellGates gates{0.1f * 0.1f, 0.7f};
  std::vector<int> found(sources.size());
  const Eigen::Matrix3f R = Eigen::AngleAxisf(0.02f, Eigen::Vector3f::UnitY()).matrix();
  const Eigen::Vector3f t(0.01f, -0.02f, 0.015f);
  match_cells(targets, camera, gates, R, t, sources, found);
  int matched = 0;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const Eigen::Vector3f p = R * sources[i].point + t, n = R * sources[i].normal;
    const int centre = cell_of(camera, kWidth, kHeight, p);
    float best = gates.max_distance2;
    int expected = -1;
    for (int k = 0; centre >= 0 && k < 9; ++k) {
      const int cell = centre + (k / 3 - 1) * kWidth + k % 3 - 1;
      const auto c = static_cast<std::size_t>(cell);
      const float d2 = filled[c] ? (points[c] - p).squaredNorm() : best;
      if (d2 < best && normals[c].dot(n) > gates.min_cosine) {
        best = d2;
        expected = cell;
      }
    }
    EXPECT_EQ(found[i], expected) << i;
    matched += expected >= 0 ? 1 : 0;
  }
  EXPECT_GT(matched, 100);
  EXPECT_EQ(found[0], -1);
  EXPECT_EQ(found[1], -1);
}

}  // namespace
}  // namespace sgs::registration
