// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/registration/photometric.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <random>

#include "sgs/camera/rgbd_frame.h"

namespace sgs::registration {
namespace {

const PinholeCamera kKeyframeCamera{320, 240, 270, 268, 161.3, 118.2};

// A slanted textured plane n.X = d in the world; grey is a sum of waves over two plane axes.
struct TexturedPlane {
  Eigen::Vector3d normal = Eigen::Vector3d(0.3, -0.2, -1).normalized();
  double offset = -1.6;
  double finest_wavelength_m = 0.05;

  double gray(const Eigen::Vector3d& p) const {
    const Eigen::Vector3d a = normal.cross(Eigen::Vector3d::UnitY()).normalized();
    const Eigen::Vector3d b = normal.cross(a);
    const double x = p.dot(a), y = p.dot(b);
    double value = 120;  // amplitudes fall like those of natural images (about 1/f)
    double wavelength = 16 * finest_wavelength_m, amplitude = 40;
    for (int k = 0; k < 5; ++k, wavelength /= 2, amplitude *= 0.55) {
      const double q = 2 * std::numbers::pi / wavelength;
      value += amplitude * std::sin(q * x + 1.3 * k) * std::cos(0.9 * q * y + 0.7 * k);
      value += 0.5 * amplitude * std::sin(0.7 * q * (x + y) + 2.1 * k);
    }
    return value;
  }
};

struct View {
  PinholeCamera camera;
  GrayPyramid pyramid;
  DepthImage depth;
};

View render(const TexturedPlane& scene, const PinholeCamera& camera, const SE3& T_middle,
            int levels, double gain = 1, double offset = 0,
            const Vector6d& readout = Vector6d::Zero()) {
  View view{camera, {}, DepthImage(camera.width, camera.height)};
  Image<float> gray(camera.width, camera.height);
  for (int v = 0; v < camera.height; ++v) {
    const SE3 T = T_middle * SE3::exp(((v + 0.5) / camera.height - 0.5) * readout);
    for (int u = 0; u < camera.width; ++u) {
      const Eigen::Vector3d ray = T.R * camera.back_project(u, v, 1);
      const double z = (scene.offset - scene.normal.dot(T.t)) / scene.normal.dot(ray);
      view.depth(u, v) = z > 0 ? static_cast<float>(z) : 0.0f;
      gray(u, v) = static_cast<float>(gain * scene.gray(T.t + z * ray) + offset);
    }
  }
  view.pyramid.build(gray, camera, levels);
  return view;
}

SE3 world_pose() {
  Vector6d xi;
  xi << 0.1, -0.05, 0.2, 0.3, -0.2, 0.1;
  return SE3::exp(xi);
}

RgbdFrame textured_frame(const SE3& T) {
  const View view = render({}, kKeyframeCamera, T, 1);
  RgbdFrame frame;
  frame.camera = kKeyframeCamera;
  frame.color = ColorImage(kKeyframeCamera.width, kKeyframeCamera.height);
  frame.depth = view.depth;
  const Image<float>& gray = view.pyramid.level(0).gray;
  for (std::size_t i = 0; i < gray.size(); ++i) {
    const auto g = static_cast<std::uint8_t>(std::clamp(std::lround(gray.data()[i]), 0L, 255L));
    frame.color.data()[i] = {g, g, g};
  }
  return frame;
}

// Coarse to fine Gauss-Newton with photometry alone.
SE3 align(const PhotometricReference& reference, const View& view, SE3 T, AffineBrightness& ab,
          const PhotometricConfig& config) {
  for (int level = reference.levels() - 1; level >= 0; --level) {
    for (int iteration = 0; iteration < 30; ++iteration) {
      auto l = linearize(reference, level, view.pyramid, view.depth, T, ab, config);
      l.H.diagonal().array() += 1e-3;
      const Vector6d xi = -l.H.ldlt().solve(l.b);
      T = T * SE3::exp(xi);
      ab = l.updated(ab, xi);
      if (xi.norm() < 1e-6) break;
    }
  }
  return T;
}

TEST(Photometric, PointsLieOnTheMeasuredSurfaceAndSkipMissingDepth) {
  PhotometricConfig config;
  config.gradient_threshold = 0.5;
  View view = render({}, kKeyframeCamera, world_pose(), 4);
  for (int v = 0; v < kKeyframeCamera.height; ++v) {
    for (int u = 0; u < kKeyframeCamera.width / 2; ++u) view.depth(u, v) = 0;
  }
  const PhotometricReference reference(view.pyramid, view.depth, world_pose(), config);
  const TexturedPlane plane;
  for (int l = 0; l < reference.levels(); ++l) {
    EXPECT_GT(reference.points(l).size(), 5U) << l;
    const int block = config.block_at(l);
    const double blocks = static_cast<double>(kKeyframeCamera.width >> l) *
                          (kKeyframeCamera.height >> l) / (block * block);
    EXPECT_LT(static_cast<double>(reference.points(l).size()), 0.6 * blocks);
    for (const auto& p : reference.points(l)) {
      const Eigen::Vector2d uv = kKeyframeCamera.project(p.p_keyframe.cast<double>());
      EXPECT_GT(uv.x(), kKeyframeCamera.width / 2 - 1 - (1 << l));
      const Eigen::Vector3d world = world_pose() * p.p_keyframe.cast<double>();
      EXPECT_NEAR(plane.normal.dot(world), plane.offset, 2e-3 * (1 << l));
    }
  }
}

TEST(Photometric, SmoothDepthReplacesTheMeasuredOneAndDropsPixels) {
  const PhotometricConfig config;
  const View view = render({}, kKeyframeCamera, SE3{}, 2);
  const auto lookup = [](int u, int) { return InverseDepthPlane{u < 160 ? 0.0f : 0.4f, 0, 0, 1}; };
  const PhotometricReference reference(view.pyramid, view.depth, SE3{}, config, lookup);
  ASSERT_FALSE(reference.points(0).empty());
  for (const auto& p : reference.points(0)) {
    EXPECT_FLOAT_EQ(p.p_keyframe.z(), 2.5f);
    EXPECT_GE(kKeyframeCamera.project(p.p_keyframe.cast<double>()).x(), 159);
  }
}

TEST(Photometric, GradientMatchesNumericalDerivativeOfTheCost) {
  PhotometricConfig config;
  TexturedPlane scene;
  scene.finest_wavelength_m = 0.8;  // smooth: bilinear gradients are then close to exact
  config.gradient_threshold = 0.05;
  View kf = render(scene, kKeyframeCamera, world_pose(), 3);
  for (int v = 0; v < kKeyframeCamera.height;
       ++v) {  // no pixel may enter or leave between the two steps
    for (int u = 0; u < kKeyframeCamera.width; ++u) {
      if (std::min(std::min(u, kKeyframeCamera.width - u),
                   std::min(v, kKeyframeCamera.height - v)) < 30) {
        kf.depth(u, v) = 0;
      }
    }
  }
  const PhotometricReference reference(kf.pyramid, kf.depth, world_pose(), config);
  Vector6d offset;
  offset << 0.004, -0.003, 0.005, 0.006, 0.008, -0.01;
  const SE3 T = world_pose() * SE3::exp(offset);
  const View view = render(scene, kKeyframeCamera, world_pose(), 3);
  const AffineBrightness ab{1.05, -3};
  for (int level = 0; level < 3; ++level) {
    const auto at = [&](const SE3& pose, const AffineBrightness& a) {
      return linearize(reference, level, view.pyramid, view.depth, pose, a, config);
    };
    const auto l = at(T, ab);
    ASSERT_GT(l.used, 30);
    // Undo the elimination: gradient of the cost at fixed gain and offset.
    const Vector6d b = l.b + l.H_pose_brightness * l.H_brightness.inverse() * l.b_brightness;
    for (int k = 0; k < 6; ++k) {
      const double h = 2e-4;
      const Vector6d e = h * Vector6d::Unit(k);
      const double numeric =
          (at(T * SE3::exp(e), ab).cost - at(T * SE3::exp(-e), ab).cost) / (2 * h);
      EXPECT_NEAR(b(k), numeric, 0.02 * b.cwiseAbs().maxCoeff())
          << "axis " << k << " level " << level;
    }
    const double ha = 1e-3, hb = 0.05;
    EXPECT_NEAR(
        l.b_brightness(0),
        (at(T, {ab.gain + ha, ab.offset}).cost - at(T, {ab.gain - ha, ab.offset}).cost) / (2 * ha),
        1e-2 * std::abs(l.b_brightness(0)));
    EXPECT_NEAR(
        l.b_brightness(1),
        (at(T, {ab.gain, ab.offset + hb}).cost - at(T, {ab.gain, ab.offset - hb}).cost) / (2 * hb),
        1e-2 * std::abs(l.b_brightness(1)));
  }
}

TEST(Photometric, TruthIsStationary) {
  const PhotometricConfig config;
  const View kf = render({}, kKeyframeCamera, world_pose(), 4);
  const PhotometricReference reference(kf.pyramid, kf.depth, world_pose(), config);
  for (int level = 0; level < 4; ++level) {
    const auto l = linearize(reference, level, kf.pyramid, kf.depth, world_pose(), {}, config);
    EXPECT_NEAR(l.cost, 0, 1e-3);
    EXPECT_EQ(l.used, l.visible);
    EXPECT_LT(l.H.ldlt().solve(l.b).norm(), 1e-5);
  }
}

TEST(Photometric, ConvergesCoarseToFineFromThreeCentimetresTwoDegrees) {
  const PhotometricConfig config;
  const PinholeCamera camera{640, 480, 540, 536, 322.8, 236.6};
  const View kf = render({}, camera, world_pose(), 5);
  const PhotometricReference reference(kf.pyramid, kf.depth, world_pose(), config);
  for (int direction = 0; direction < 6; ++direction) {
    const double sign = direction % 2 == 0 ? 1 : -1;
    Vector6d motion;
    motion << Eigen::Vector3d(1, sign, 0.5).normalized() * (2 * std::numbers::pi / 180),
        Eigen::Vector3d::Unit(direction / 2) * 0.03 * sign;
    const SE3 truth = world_pose() * SE3::exp(motion);
    const View view = render({}, camera, truth, 5);
    AffineBrightness ab;
    const SE3 T = align(reference, view, world_pose(), ab, config);
    const SE3 error = truth.inverse() * T;
    EXPECT_LT(error.t.norm(), 5e-4) << direction;
    EXPECT_LT(error.angle(), 5e-4) << direction;
  }
}

TEST(Photometric, GainAndOffsetAreEstimatedAndDoNotMoveThePose) {
  const PhotometricConfig config;
  const View kf = render({}, kKeyframeCamera, world_pose(), 5);
  const PhotometricReference reference(kf.pyramid, kf.depth, world_pose(), config);
  Vector6d motion;
  motion << 0.01, -0.015, 0.01, 0.015, 0.01, -0.01;
  const SE3 truth = world_pose() * SE3::exp(motion);
  const View view = render({}, kKeyframeCamera, truth, 5, 1.2, -15);
  AffineBrightness ab;
  const SE3 T = align(reference, view, world_pose(), ab, config);
  const SE3 error = truth.inverse() * T;
  EXPECT_LT(error.t.norm(), 5e-4);
  EXPECT_LT(error.angle(), 5e-4);
  EXPECT_NEAR(ab.gain, 1.2, 0.01);
  EXPECT_NEAR(ab.offset, -15, 1.5);
}

// Gauss-Newton with the readout's rotation as three more unknowns of the frame.
struct RollingAlignment {
  SE3 T;
  Vector6d readout = Vector6d::Zero();
};
RollingAlignment align_rolling(const PhotometricReference& reference, const View& view, SE3 T,
                               const PhotometricConfig& config) {
  RollingAlignment out{T, Vector6d::Zero()};
  AffineBrightness ab;
  for (int level = reference.levels() - 1; level >= 0; --level) {
    for (int iteration = 0; iteration < 20; ++iteration) {
      const auto l = linearize(reference, level, view.pyramid, view.depth, out.T, ab, config,
                               ReadoutMotion(out.readout));
      Eigen::Matrix<double, 9, 9> H;
      H << l.H, l.H_pose_readout, l.H_pose_readout.transpose(), l.H_readout;
      H.diagonal().array() += 1e-3;
      Eigen::Matrix<double, 9, 1> b;
      b << l.b, l.b_readout;
      const Eigen::Matrix<double, 9, 1> step = -H.ldlt().solve(b);
      out.T = out.T * SE3::exp(step.head<6>());
      out.readout.head<3>() += step.tail<3>();
      ab = l.updated(ab, step.head<6>(), step.tail<3>());
    }
  }
  return out;
}

TEST(Photometric, TurnOfARollingShutterIsSeenAndDoesNotMoveThePose) {
  const PhotometricConfig config;
  const View kf = render({}, kKeyframeCamera, world_pose(), 5);
  const PhotometricReference reference(kf.pyramid, kf.depth, world_pose(), config);
  Vector6d motion, readout;
  motion << 0.01, -0.012, 0.008, 0.015, 0.01, -0.01;
  readout << 0.012, -0.016, 0.006, 0, 0, 0;  // half a rad/s for 30 ms
  const SE3 truth = world_pose() * SE3::exp(motion);
  const View view = render({}, kKeyframeCamera, truth, 5, 1, 0, readout);
  const RollingAlignment found = align_rolling(reference, view, world_pose(), config);
  EXPECT_LT((found.readout - readout).norm(), 0.1 * readout.norm());
  const SE3 error = truth.inverse() * found.T;
  EXPECT_LT(error.t.norm(), 2e-3);
  EXPECT_LT(error.angle(), 2e-3);
  AffineBrightness ab;
  const SE3 unaware = align(reference, view, world_pose(), ab, config);
  EXPECT_GT((truth.inverse() * unaware).t.norm(), 4 * error.t.norm());
}

TEST(Photometric, KeyframesOfARollingShutterAreStraightened) {
  const PhotometricConfig config;
  Vector6d readout;
  readout << 0.01, -0.015, 0.02, 0.004, -0.006, 0.002;
  const View kf = render({}, kKeyframeCamera, world_pose(), 3, 1, 0, readout);
  const PhotometricReference reference(kf.pyramid, kf.depth, world_pose(), config, {},
                                       ReadoutMotion(readout));
  const TexturedPlane plane;
  for (const auto& p : reference.points(0)) {
    const Eigen::Vector3d world = world_pose() * p.p_keyframe.cast<double>();
    EXPECT_NEAR(plane.normal.dot(world), plane.offset, 1e-3);
    EXPECT_NEAR(plane.gray(world), static_cast<double>(p.intensity), 8);
  }
}

TEST(Photometric, HiddenPixelsCountAsVisibleButAreNotUsed) {
  const PhotometricConfig config;
  View view = render({}, kKeyframeCamera, world_pose(), 3);
  const PhotometricReference reference(view.pyramid, view.depth, world_pose(), config);
  const auto before = linearize(reference, 0, view.pyramid, view.depth, world_pose(), {}, config);
  for (int v = 0; v < kKeyframeCamera.height; ++v) {
    for (int u = 0; u < kKeyframeCamera.width / 2; ++u) view.depth(u, v) *= 0.7f;
  }
  const auto after = linearize(reference, 0, view.pyramid, view.depth, world_pose(), {}, config);
  EXPECT_EQ(before.visible, after.visible);
  EXPECT_LT(after.used, 0.7 * before.used);
  view.depth.fill(0);  // unknown depth hides nothing
  EXPECT_EQ(linearize(reference, 0, view.pyramid, view.depth, world_pose(), {}, config).used,
            before.used);
}

TEST(Photometric, InformationDoesNotDependOnTheWorldsOrigin) {
  const PhotometricConfig config;
  const View view = render({}, kKeyframeCamera, world_pose(), 3);
  PhotometricReference reference(view.pyramid, view.depth, world_pose(), config);
  Vector6d off;
  off << 0.002, 0.001, 0, 0.003, 0, 0.001;
  const SE3 T = world_pose() * SE3::exp(off);
  const auto near = linearize(reference, 0, view.pyramid, view.depth, T, {}, config);
  const SE3 shift(Eigen::Matrix3d::Identity(), Eigen::Vector3d(100, -50, 20));
  reference.set_pose(shift * world_pose());
  const auto far = linearize(reference, 0, view.pyramid, view.depth, shift * T, {}, config);
  EXPECT_LT((near.H - far.H).norm(), 1e-4 * near.H.norm());
  EXPECT_LT((near.b - far.b).norm(), 1e-3 * near.b.norm());
}

TEST(Photometric, TwoReferencesAddUpAndResultsRepeatBitForBit) {
  const PhotometricConfig config;
  Vector6d other;
  other << 0, 0.05, 0, 0.08, 0, 0;
  const SE3 T_a = world_pose(), T_b = world_pose() * SE3::exp(other);
  const View a = render({}, kKeyframeCamera, T_a, 3),
             b = render({}, kKeyframeCamera, T_b, 3, 0.9, 8);
  const PhotometricReference ra(a.pyramid, a.depth, T_a, config),
      rb(b.pyramid, b.depth, T_b, config);
  Vector6d half;
  half << 0, 0.004, 0, 0.005, 0, 0;
  const SE3 truth = T_a * SE3::exp(half);
  const View view = render({}, kKeyframeCamera, truth, 3);
  SE3 T = T_a;
  AffineBrightness ab_a, ab_b;
  for (int i = 0; i < 15; ++i) {
    const auto la = linearize(ra, 0, view.pyramid, view.depth, T, ab_a, config);
    const auto lb = linearize(rb, 0, view.pyramid, view.depth, T, ab_b, config);
    const auto again = linearize(rb, 0, view.pyramid, view.depth, T, ab_b, config);
    ASSERT_EQ(std::memcmp(lb.H.data(), again.H.data(), sizeof(double) * 36), 0);
    const Vector6d xi = -(la.H + lb.H).ldlt().solve(la.b + lb.b);
    T = T * SE3::exp(xi);
    ab_a = la.updated(ab_a, xi);
    ab_b = lb.updated(ab_b, xi);
  }
  EXPECT_LT((truth.inverse() * T).t.norm(), 1e-3);
  EXPECT_NEAR(ab_b.gain, 1 / 0.9, 0.02);
}

TEST(Photometric, BadConfigurationValuesAreRefused) {
  PhotometricConfig config;
  ParameterList list;
  config.declare(list);
  EXPECT_TRUE(list.set("sigma", "4").has_value());
  EXPECT_EQ(config.sigma, 4);
  EXPECT_FALSE(list.set("levels", "0").has_value());
}

TEST(PhotometricReference, FollowsDepthThatIsKnownBetter) {
  const View view = render({}, kKeyframeCamera, SE3{}, 3);
  DepthCalibration lens;
  lens.camera = kKeyframeCamera;
  lens.grid = {5, 4};
  for (int k = 0; k < 20; ++k) lens.offset_per_m.push_back(0.01 * std::sin(1.7 * k));
  lens.shift_px = {1.4, -0.9};
  const DepthImage better = lens.apply(view.depth);
  // The surface around a pixel: inverse depth is affine on a plane.
  const SurfaceLookup surface = [&](int u, int v) {
    const auto q = [&](int x, int y) { return 1 / view.depth(x, y); };
    const int x = std::min(u, kKeyframeCamera.width - 2),
              y = std::min(v, kKeyframeCamera.height - 2);
    return InverseDepthPlane{q(u, v), q(x + 1, y) - q(x, y), q(x, y + 1) - q(x, y), 1};
  };
  PhotometricReference reference(view.pyramid, view.depth, SE3{}, {}, surface);
  reference.change_depth(DepthChange({}, lens));
  int compared = 0;
  for (int level = 0; level < reference.levels(); ++level) {
    for (const PhotometricPoint& p : reference.points(level)) {
      const Eigen::Vector2d uv = kKeyframeCamera.project(p.p_keyframe.cast<double>());
      const int u = static_cast<int>(std::lround(uv.x())),
                v = static_cast<int>(std::lround(uv.y()));
      if (level > 0 || u < 3 || v < 3 || u > kKeyframeCamera.width - 4 ||
          v > kKeyframeCamera.height - 4)
        continue;
      ASSERT_NEAR(1 / p.p_keyframe.z(), 1 / better(u, v), 2e-5f) << u << " " << v;
      ++compared;
    }
  }
  EXPECT_GT(compared, 100);
}

// Colours that no camera saw must not count, whatever they are.
TEST(Photometric, PixelsThatWereNotSeenAreNotUsed) {
  const PhotometricConfig config;
  RgbdFrame keyframe = textured_frame(world_pose());
  PixelMask seen(kKeyframeCamera.width, kKeyframeCamera.height, std::uint8_t{1});
  for (int v = 0; v < seen.height(); ++v) std::fill_n(seen.row(v), 120, std::uint8_t{0});
  const auto pyramid_of = [&](RgbdFrame frame, Rgb8 colour, bool masked) {
    for (int v = 0; v < seen.height(); ++v) std::fill_n(frame.color.row(v), 120, colour);
    GrayPyramid pyramid;
    pyramid.build(frame.color, frame.camera, 3, masked ? &seen : nullptr);
    return pyramid;
  };
  const PhotometricReference all(pyramid_of(keyframe, {0, 0, 0}, false), keyframe.depth,
                                 world_pose(), config);
  const PhotometricReference reference(pyramid_of(keyframe, {0, 0, 0}, true), keyframe.depth,
                                       world_pose(), config);
  Vector6d motion;
  motion << 0.004, -0.006, 0.003, 0.008, 0.004, -0.005;
  const SE3 T = world_pose() * SE3::exp(motion);
  const RgbdFrame frame = textured_frame(T);
  const GrayPyramid black = pyramid_of(frame, {0, 0, 0}, true);
  const GrayPyramid white = pyramid_of(frame, {255, 255, 255}, true);
  for (int level = 0; level < 3; ++level) {
    ASSERT_GT(reference.points(level).size(), 50u);
    for (const auto& p : reference.points(level)) {
      EXPECT_GT(kKeyframeCamera.project(p.p_keyframe.cast<double>()).x(), 120);
    }
    // The frame's own mask holds against a keyframe that saw more.
    const auto a = linearize(all, level, black, frame.depth, T, {}, config);
    const auto b = linearize(all, level, white, frame.depth, T, {}, config);
    const auto c = linearize(all, level, pyramid_of(frame, {255, 255, 255}, false), frame.depth, T,
                             {}, config);
    EXPECT_EQ(a.H, b.H);
    EXPECT_EQ(a.b, b.b);
    EXPECT_EQ(a.used, b.used);
    EXPECT_LT(a.used, c.used);
    EXPECT_TRUE(a.H.allFinite() && a.b.allFinite());
    EXPECT_LT(a.cost / a.used, c.cost / c.used);
  }
}

// What VisualTerm does over frames, here on one: sigma times the square root of square_sum / used,
// until it stands still.
TEST(Photometric, SquaresTellHowWideTheNoiseIs) {
  PhotometricConfig config;
  config.sigma_level_factor = 1;
  const View kf = render({}, kKeyframeCamera, world_pose(), 1);
  const PhotometricReference reference(kf.pyramid, kf.depth, world_pose(), config);
  for (const double true_sigma : {1.5, 6.0, 20.0}) {
    std::mt19937_64 random(11);
    std::student_t_distribution<double> noise(config.t_dof);
    Image<float> gray = kf.pyramid.level(0).gray;
    for (std::size_t i = 0; i < gray.size(); ++i) {
      gray.data()[i] += static_cast<float>(true_sigma * noise(random));
    }
    GrayPyramid noisy;
    noisy.build(gray, kKeyframeCamera, 1);
    double width = 1;
    for (int step = 0; step < 60; ++step) {
      const auto l =
          linearize(reference, 0, noisy, kf.depth, world_pose(), {}, config, {}, true, width);
      width *= std::sqrt(l.square_sum / l.used);
    }
    EXPECT_NEAR(width * config.sigma, true_sigma, 0.12 * true_sigma);
  }
}

}  // namespace
}  // namespace sgs::registration
