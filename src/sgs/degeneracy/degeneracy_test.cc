// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "sgs/core/error.h"
#include "sgs/degeneracy/fusion.h"
#include "sgs/degeneracy/observability.h"
#include "sgs/degeneracy/planarity.h"
#include "sgs/degeneracy/spectrum.h"

namespace sgs::degeneracy {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kNormalNoise = 0.02;  // rad

struct Scene {
  std::vector<Eigen::Vector3f> points, normals;
  std::vector<float> weights, noise;
  std::mt19937_64 rng{7};

  double uniform(double lo, double hi) {
    return lo + (hi - lo) * static_cast<double>(rng() >> 11) * 0x1p-53;
  }
  void add(const Vector3d& p, Vector3d n) {
    // Noise of the right size per tangent direction (uniform with that standard deviation).
    const double a = kNormalNoise * std::sqrt(3.0);
    n = (n.normalized() + Vector3d(uniform(-a, a), uniform(-a, a), uniform(-a, a))).normalized();
    points.push_back(p.cast<float>());
    normals.push_back(n.cast<float>());
    weights.push_back(1e5f);
    noise.push_back(static_cast<float>(kNormalNoise));
  }
  void patch(const Vector3d& centre, const Vector3d& a, const Vector3d& b, int n) {
    for (int i = 0; i < n; ++i) {
      add(centre + uniform(-1, 1) * a + uniform(-1, 1) * b, a.cross(b));
    }
  }
  SurfaceSamples samples() const { return {points, normals, weights, noise}; }
};

Scene plane(double z) {
  Scene s;
  s.patch({0.1, 0.05, z}, {0.5 * z, 0, 0}, {0, 0.4 * z, 0}, 3000);
  return s;
}
Scene fold() {
  Scene s;  // edge along y
  s.patch({-0.5, 0, 2}, {0.5, 0, 0.3}, {0, 0.7, 0}, 1500);
  s.patch({0.5, 0, 2}, {0.5, 0, -0.3}, {0, 0.7, 0}, 1500);
  return s;
}
Scene corridor() {
  Scene s;  // along z
  for (double side : {-1.0, 1.0}) {
    s.patch({side, 0, 3}, {0, 1, 0}, {0, 0, 2}, 1000);
    s.patch({0, side, 3}, {1, 0, 0}, {0, 0, 2}, 1000);
  }
  return s;
}
Scene corner() {
  Scene s;
  s.patch({0.5, 0.5, 3}, {0.5, 0, 0}, {0, 0.5, 0}, 1000);
  s.patch({0, 0.5, 2.5}, {0, 0.5, 0}, {0, 0, 0.5}, 1000);
  s.patch({0.5, 0, 2.5}, {0.5, 0, 0}, {0, 0, 0.5}, 1000);
  return s;
}
const Vector3d kCylinderCentre(0.2, 0, 2.5), kSphereCentre(0.1, -0.2, 2);
Scene cylinder() {
  Scene s;  // axis along y, the visible half
  for (int i = 0; i < 3000; ++i) {
    const double t = s.uniform(0, std::numbers::pi), y = s.uniform(-1, 1);
    const Vector3d n(std::cos(t), 0, -std::sin(t));
    s.add(kCylinderCentre + 0.8 * n + Vector3d(0, y, 0), n);
  }
  return s;
}
Scene sphere() {
  Scene s;
  while (s.points.size() < 3000) {
    const Vector3d n(s.uniform(-1, 1), s.uniform(-1, 1), s.uniform(-1, 0));
    if (n.norm() > 1 || n.norm() < 0.1) continue;
    s.add(kSphereCentre + 0.7 * n.normalized(), n);
  }
  return s;
}
Scene two_parallel_planes() {
  Scene s = plane(1.5);
  s.patch({0.2, 0, 2.5}, {0.8, 0, 0}, {0, 0.6, 0}, 1500);
  return s;
}
Scene clutter_before_wall(int clutter) {
  Scene s = plane(2.5);
  for (int i = 0; i < clutter; ++i) {
    const Vector3d n(s.uniform(-1, 1), s.uniform(-1, 1), s.uniform(-1, -0.2));
    s.add({s.uniform(-0.8, 0.8), s.uniform(-0.6, 0.6), s.uniform(1, 2)}, n);
  }
  return s;
}

Observability detect(const Scene& s) {
  HysteresisState state;
  return observe(accumulate(s.samples(), 4), {}, state);
}

// Camera twist of a rotation about an axis through `point`, or of a translation.
Vector6d rotation_about(const Vector3d& axis, const Vector3d& point) {
  Vector6d xi;
  xi << axis, -axis.cross(point);
  return xi;
}
Vector6d translation(const Vector3d& direction) {
  Vector6d xi;
  xi << Vector3d::Zero(), direction;
  return xi;
}

const Vector3d X = Vector3d::UnitX(), Y = Vector3d::UnitY(), Z = Vector3d::UnitZ();

struct Case {
  std::string name;
  std::function<Scene()> scene;
  std::vector<Vector6d> unseen;
};

std::vector<Case> cases() {
  return {
      {"plane 1 m",
       [] { return plane(1); },
       {translation(X), translation(Y), rotation_about(Z, {0, 0, 1})}},
      {"plane 2.5 m",
       [] { return plane(2.5); },
       {translation(X), translation(Y), rotation_about(Z, {0, 0, 2.5})}},
      {"two parallel planes",
       two_parallel_planes,
       {translation(X), translation(Y), rotation_about(Z, Vector3d::Zero())}},
      {"fold", fold, {translation(Y)}},
      {"corridor", corridor, {translation(Z)}},
      {"cylinder", cylinder, {translation(Y), rotation_about(Y, kCylinderCentre)}},
      {"sphere",
       sphere,
       {rotation_about(X, kSphereCentre), rotation_about(Y, kSphereCentre),
        rotation_about(Z, kSphereCentre)}},
      {"corner", corner, {}},
      {"few clutter points",
       [] { return clutter_before_wall(3); },
       {translation(X), translation(Y), rotation_about(Z, {0, 0, 2.5})}},
      {"sparse clutter", [] { return clutter_before_wall(300); }, {}},
  };
}

TEST(Observability, AnalyticScenesReportTheRightAxes) {
  for (const Case& c : cases()) {
    const Scene s = c.scene();
    const Observability o = detect(s);
    EXPECT_EQ(std::popcount(o.mask), static_cast<int>(c.unseen.size()))
        << c.name << " snr " << o.snr.transpose();
    const Matrix6d to_scaled = accumulate(s.samples(), 1).scaled_from_camera();
    for (const Vector6d& xi : c.unseen) {
      // P keeps the unseen twist and K removes it (compared where all axes are in metres).
      EXPECT_LT((to_scaled * (o.K * xi)).norm(), 0.1 * (to_scaled * xi).norm()) << c.name;
    }
    EXPECT_NEAR((o.P + o.K - Matrix6d::Identity()).norm(), 0, 1e-12);
    if (c.unseen.empty()) {
      EXPECT_EQ(o.weights.maxCoeff(), 0) << c.name << o.snr.transpose();
    }
  }
}

TEST(Observability, CameraAxesAreUnitTwistsThatTheirWeightsBelongTo) {
  for (const Case& c : cases()) {
    const Observability o = detect(c.scene());
    for (int k = 0; k < 6; ++k) {
      const Vector6d axis = o.camera_axes.col(k);
      EXPECT_NEAR(axis.norm(), 1, 1e-12) << c.name;
      EXPECT_LT((o.P * axis - o.weights(k) * axis).norm(), 1e-9) << c.name << " axis " << k;
    }
  }
}

TEST(Observability, NoiseOnlyRatioIsAboutOneOnAPlane) {
  const Observability o = detect(plane(2));
  for (int k = 0; k < 3; ++k) {
    EXPECT_GT(o.snr(k), 0.5);
    EXPECT_LT(o.snr(k), 2);
  }
  EXPECT_GT(o.snr(3), 100);
}

TEST(Observability, OrderAndSignsOfNormalsDoNotMatter) {
  for (const Case& c : cases()) {
    Scene s = c.scene();
    // Every point in the noise sum, else the order chooses which ones are.
    HysteresisState sa, sb;
    const Observability a = observe(accumulate(s.samples(), 1), {}, sa);
    const std::size_t n = s.points.size();
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t j = i + s.rng() % (n - i);
      std::swap(s.points[i], s.points[j]);
      std::swap(s.normals[i], s.normals[j]);
      if (s.rng() & 1U) s.normals[i] = -s.normals[i];
    }
    const Observability b = observe(accumulate(s.samples(), 1), {}, sb);
    EXPECT_EQ(a.mask, b.mask) << c.name;
    EXPECT_LT((a.weights - b.weights).norm(), 1e-6) << c.name;
    EXPECT_LT((a.P - b.P).norm(), 1e-5 * (1 + a.P.norm())) << c.name;
  }
}

TEST(Observability, UnitsOfLengthDoNotMatter) {
  for (const Case& c : cases()) {
    Scene s = c.scene();
    const Observability metres = detect(s);
    for (auto& p : s.points) p *= 1000.0f;
    for (auto& w : s.weights) w *= 1e-6f;
    const Observability millimetres = detect(s);
    EXPECT_EQ(metres.mask, millimetres.mask) << c.name;
    EXPECT_LT((metres.weights - millimetres.weights).norm(), 1e-4) << c.name;
    Vector6d units;  // twist in metres -> twist in millimetres
    units << 1, 1, 1, 1000, 1000, 1000;
    const Matrix6d expected = units.asDiagonal() * metres.P * units.cwiseInverse().asDiagonal();
    const Matrix6d difference =
        units.cwiseInverse().asDiagonal() * (expected - millimetres.P) * units.asDiagonal();
    EXPECT_LT(difference.norm(), 1e-2) << c.name;
  }
}

TEST(Observability, MovingTheOriginByAHundredMetresChangesNoDecision) {
  for (const Case& c : cases()) {
    Scene s = c.scene();
    HysteresisState sa, sb;
    const Observability a = observe(accumulate(s.samples(), 4), {}, sa);
    for (auto& p : s.points) p += Eigen::Vector3f(100, -40, 30);
    const Observability b = observe(accumulate(s.samples(), 4), {}, sb);
    EXPECT_EQ(a.mask, b.mask) << c.name;
    EXPECT_LT((a.weights - b.weights).norm(), 1e-2) << c.name;
  }
}

TEST(Observability, HysteresisHoldsAWeakAxisAndDoesNotRatchet) {
  DegeneracyConfig config;
  SurfaceInformation info;
  info.count = 1000;
  info.radius_m = 1;
  info.N = Matrix6d::Identity();
  const auto step = [&](double snr, HysteresisState& state, int axis = 2) {
    info.H = 100 * Matrix6d::Identity();
    info.H(axis, axis) = snr;
    return observe(info, config, state);
  };
  HysteresisState state;
  EXPECT_NEAR(step(8, state).weights(0), std::log2(10.0 / 8), 1e-9);
  for (int i = 0; i < 50; ++i) EXPECT_LT(step(8, state).weights(0), 0.4);  // no slow drift
  EXPECT_EQ(step(4, state).weights(0), 1);
  for (int i = 0; i < 50; ++i) EXPECT_EQ(step(8, state).weights(0), 1);  // held
  EXPECT_LT(step(8, state, 3).weights(0), 0.4) << "another axis has no history";
  EXPECT_EQ(step(4, state).weights(0), 1);
  EXPECT_LT(step(16, state).weights(0), 0.5);  // released
  EXPECT_LT(step(8, state).weights(0), 0.4);
}

TEST(Observability, HysteresisFollowsTheSceneThroughACameraRotation) {
  DegeneracyConfig config;
  const double angle = 1.0;
  const Matrix3d R = so3_exp(Vector3d(0, 0, angle));
  SurfaceInformation info;
  info.count = 1000;
  info.radius_m = 1;
  info.N = Matrix6d::Identity();
  info.H = 100 * Matrix6d::Identity();
  info.H(3, 3) = 4;  // translation along x
  HysteresisState state;
  observe(info, config, state);
  info.H(3, 3) = 8;
  const Matrix6d Ad = SE3(R, Vector3d::Zero()).adjoint();  // previous from current
  info.H = (Ad.transpose() * info.H * Ad).eval();
  HysteresisState copy = state;
  EXPECT_NEAR(observe(info, config, state, SE3(R, Vector3d::Zero())).weights(0), 1, 1e-9);
  EXPECT_LT(observe(info, config, copy).weights(0), 0.999);
}

TEST(Observability, TooFewPointsSeeNothing) {
  HysteresisState state;
  const Observability o = observe(accumulate({}, 4), {}, state);
  EXPECT_EQ(o.mask, 0x3fU);
  EXPECT_EQ(o.K.norm(), 0);
}

TEST(ConditionTest, FlagsAxesBeyondTheThresholdOnly) {
  Vector6d d;
  d << 1000, 1, 4, 500, 6, 1000;
  const Spectrum s = spectrum(d.asDiagonal());
  EXPECT_EQ(condition_mask(s, 200), 0b000011U);
  EXPECT_EQ(condition_mask(s, 1000), 0U);
  EXPECT_NEAR(s.condition_number(), 1000, 1e-9);
  EXPECT_EQ(condition_mask(spectrum(Matrix6d::Zero()), 200), 0x3fU);
  EXPECT_TRUE(std::isinf(spectrum(Matrix6d::Zero()).condition_number()));
  EXPECT_THROW(spectrum(Matrix6d::Constant(NAN)), ContractViolation);
}

TEST(Planarity, SignFreeScoreOrdersScenesAndIgnoresSigns) {
  Scene p = plane(1), f = fold(), c = corner();
  const double plane_eta = planarity(p.normals, p.weights).eta;
  EXPECT_GT(plane_eta, 0.98);
  EXPECT_LT(planarity(c.normals, c.weights).eta, 0.1);
  EXPECT_LT(planarity(f.normals, f.weights).eta, 0.9);
  for (Scene* s : {&p, &f, &c}) {
    const double before = planarity(s->normals, s->weights).eta;
    for (auto& n : s->normals) {
      if (s->rng() & 1U) n = -n;
    }
    EXPECT_NEAR(planarity(s->normals, s->weights).eta, before, 1e-12);
  }
}

TEST(Planarity, PaperScoreNeedsRandomSigns) {
  const DegeneracyConfig config;
  Scene p = plane(1);
  EXPECT_LT(paper_planarity(p.normals, p.weights, config).eta, 0.1) << "oriented: upside down";
  for (auto& n : p.normals) {
    if (p.rng() & 1U) n = -n;
  }
  EXPECT_EQ(paper_planarity(p.normals, p.weights, config).eta, 1);
  EXPECT_EQ(paper_planarity({}, {}, config).eta, 0);
  EXPECT_NEAR(planarity_gate(1, 5), 1, 1e-12);
  EXPECT_NEAR(planarity_gate(0.5, 5), std::exp(-2.5), 1e-12);
}

Matrix6d example_information() {
  const Vector6d a = Vector6d::LinSpaced(1, 3.5);
  Vector6d d;
  d << 2000, 1500, 3000, 2, 1, 2500;
  return Matrix6d(d.asDiagonal()) + 0.05 * a * a.transpose();
}

TEST(PaperFusion, GradientIsTheDerivativeOfTheCost) {
  DegeneracyConfig config;
  Vector6d xi;
  xi << 0.1, -0.2, 0.15, 0.3, 0.1, -0.2;
  const SE3 T_prior = SE3::exp(xi), T = T_prior * SE3::exp(0.7 * xi.reverse());
  const Matrix6d omega = Matrix6d(Vector6d::LinSpaced(1, 6).asDiagonal());
  for (double eta : {0.3, 0.9}) {
    const AxisPrior prior = make_axis_prior(example_information(), T_prior, omega, eta, config);
    ASSERT_NE(prior.mask, 0U);
    EXPECT_EQ(prior.full, eta > 0.5);
    NormalEquations ne;
    add_prior(prior, T, ne);
    EXPECT_NEAR(ne.cost, prior_cost(prior, T), 1e-12);
    for (int k = 0; k < 6; ++k) {
      const double h = 1e-5;
      const Vector6d e = h * Vector6d::Unit(k);
      const double numeric =
          (prior_cost(prior, T * SE3::exp(e)) - prior_cost(prior, T * SE3::exp(-e))) / (2 * h);
      EXPECT_NEAR(ne.b(k), numeric, 1e-5 * (1 + ne.b.norm()));
    }
  }
}

TEST(PaperFusion, RescalesToTheTraceAndActsOnDegenerateAxesOnly) {
  DegeneracyConfig config;
  config.soft_gate = false;
  const Matrix6d H = example_information();
  const AxisPrior p = make_axis_prior(H, {}, 7 * Matrix6d::Identity(), 0.2, config);
  const Spectrum s = spectrum(H);
  ASSERT_EQ(p.mask, 0b11U);
  const double per_axis = H.trace() / 6;
  EXPECT_NEAR(s.axes.col(0).dot(p.weight * s.axes.col(0)), per_axis, 1e-6 * per_axis);
  EXPECT_NEAR((p.weight * s.axes.col(5)).norm(), 0, 1e-9 * per_axis);
  const AxisPrior full = make_axis_prior(H, {}, 7 * Matrix6d::Identity(), 0.9, config);
  EXPECT_NEAR(full.weight.trace(), H.trace(), 1e-6 * H.trace());
  const AxisPrior none = make_axis_prior(100 * Matrix6d::Identity(), {}, H, 0.9, config);
  EXPECT_EQ(none.mask, 0U);
  EXPECT_EQ(none.weight.norm(), 0);
}

TEST(Removal, ConfidentlyWrongGeometryOnAWeakAxisHasNoSay) {
  const Scene s = plane(2);
  const SurfaceInformation info = accumulate(s.samples(), 4);
  HysteresisState state;
  const DegeneracyConfig config;
  const Observability o = observe(info, config, state);
  const Matrix6d S = info.scaled_from_camera();
  NormalEquations geometry, vision;
  geometry.H = S.transpose() * (info.H + 1e8 * Matrix6d::Identity()) * S;
  Vector6d wrong, truth;
  wrong = translation(Vector3d(0.1, 0, 0));
  truth = translation(Vector3d(-0.02, 0.01, 0));
  geometry.b = -geometry.H * wrong;
  vision.H = 1e5 * Matrix6d::Identity();
  vision.b = -vision.H * truth;
  const NormalEquations removed = fuse_removed(geometry, o.K, vision, config);
  const Vector6d step = -removed.H.ldlt().solve(removed.b);
  EXPECT_NEAR(step(3), -0.02, 3e-3);
  EXPECT_NEAR(step(4), 0.01, 3e-3);
  const NormalEquations joint = fuse_joint(geometry, vision, config);
  EXPECT_NEAR((-joint.H.ldlt().solve(joint.b))(3), 0.1, 5e-3) << "without removal it wins";
  EXPECT_NEAR((removed.H - removed.H.transpose()).norm(), 0, 1e-6 * removed.H.norm());
}

/// Equations of points all around the camera whose minimum is at `x`.
NormalEquations around(const Vector6d& x, double weight) {
  NormalEquations out;
  std::mt19937 bits(11);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d p = Eigen::Vector3d(normal(bits), normal(bits), 2 + normal(bits));
    const Eigen::Vector3d n =
        Eigen::Vector3d(normal(bits), normal(bits), normal(bits)).normalized();
    Vector6d J;
    J << p.cross(n), n;
    out.H += weight * J * J.transpose();
  }
  out.b = -out.H * x;
  return out;
}

Vector6d minimum(const NormalEquations& e) { return -e.H.ldlt().solve(e.b); }

TEST(Fusion, TranslationAloneHasTheSameMinimumAndNoOpinionOnRotation) {
  Vector6d x;
  x << 0.01, -0.02, 0.03, 0.1, 0.2, -0.1;
  const NormalEquations place = translation_alone(around(x, 100));
  EXPECT_EQ(place.H.topRows(3).norm(), 0);
  EXPECT_EQ(place.b.head(3).norm(), 0);
  const Eigen::Matrix3d H = place.H.bottomRightCorner<3, 3>();
  const Eigen::Vector3d t = -H.ldlt().solve(place.b.tail<3>());
  EXPECT_NEAR((t - x.tail<3>()).norm(), 0, 1e-4);
  EXPECT_TRUE(translation_alone({}).H.isZero(0)) << "nothing is known of nothing";
}

TEST(Fusion, GeometryAloneStaysWhereItIsWhateverItsShareOfTheTurn) {
  Vector6d x;
  x << 0.01, -0.02, 0.03, 0.1, 0.2, -0.1;
  for (const double share : {0.0, 0.1, 1.0}) {
    DegeneracyConfig config;
    config.damping = 1e-9;
    config.geometry_turn_share = share;
    const NormalEquations joint = fuse_joint(around(x, 100), around(x, 1), config);
    EXPECT_NEAR((minimum(joint) - x).norm(), 0, 1e-4) << share;
  }
}

// Both see everything and contradict each other: the picture turns the camera, surfaces place it.
TEST(Fusion, PicturesTurnAndSurfacesPlace) {
  Vector6d surfaces = Vector6d::Zero(), picture = Vector6d::Zero();
  surfaces << 0.01, 0.01, 0.01, 0.02, 0.02, 0.02;
  const auto between = [&](double share) {
    DegeneracyConfig config;
    config.geometry_turn_share = share;
    const Vector6d x = minimum(fuse_joint(around(surfaces, 1e4), around(picture, 1e4), config));
    return Eigen::Vector2d(x.head<3>().norm() / surfaces.head<3>().norm(),
                           x.tail<3>().norm() / surfaces.tail<3>().norm());
  };
  const Eigen::Vector2d all = between(1), tenth = between(0.1);
  EXPECT_NEAR(all(0), all(1), 0.05);
  EXPECT_LT(tenth(0), 0.6 * all(0));
  EXPECT_GT(tenth(1), 2 * tenth(0));
}

TEST(DegeneracyConfig, DeclaresItsParameters) {
  DegeneracyConfig config;
  ParameterList list;
  config.declare(list);
  EXPECT_TRUE(list.set("snr_threshold", "7").has_value());
  EXPECT_EQ(config.snr_threshold, 7);
  EXPECT_FALSE(list.set("hysteresis", "0.5").has_value());
}

TEST(SurfaceInformation, WithoutASurfaceTwistsStayAsTheyAre) {
  const SurfaceInformation nothing = accumulate({}, 1);
  EXPECT_TRUE(nothing.camera_from_scaled().isIdentity(0));
  EXPECT_TRUE(nothing.scaled_from_camera().isIdentity(0));
}

}  // namespace
}  // namespace sgs::degeneracy
