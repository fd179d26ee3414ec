// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <hwy/targets.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <mutex>

#include "sgs/render/test_scene.h"

namespace sgs::render {
namespace {

using testing::Random;

struct Scene {
  PinholeCamera camera;
  SE3 pose;
  std::vector<map::Gaussian> gaussians;
  TrainingImage training;
};

TrainingImage training_for(const Scene& s, Random& random) {
  Rendering rendering;
  make_reference_rasterizer()->render(s.gaussians, s.camera, s.pose, rendering);
  return testing::training_image_beside(rendering, s.camera, random);
}

Scene make_scene(int width, int height, int count, double sigma_px, std::uint64_t seed) {
  Random random(seed);
  Scene s{testing::small_camera(width, height), testing::tilted_pose(), {}, {}};
  s.gaussians = testing::random_gaussians(s.camera, s.pose, count, sigma_px, random);
  s.training = training_for(s, random);
  return s;
}

/// Everything that can go to extremes at once.
Scene make_edge_scene(int width, int height, std::uint64_t seed) {
  Random random(seed);
  Scene s{testing::small_camera(width, height), testing::tilted_pose(), {}, {}};
  const auto add = [&](double u, double v, double z, double sigma) -> map::Gaussian& {
    s.gaussians.push_back(testing::gaussian_at(s.camera, s.pose, u, v, z, sigma, random));
    return s.gaussians.back();
  };
  for (int i = 0; i < 60; ++i) {
    const double u = random.uniform(0, width), v = random.uniform(0, height);
    const double z = random.uniform(0.5, 4);
    switch (i % 10) {
      case 0:
        add(random.uniform(0, 1) < 0.5 ? 0 : width - 1, v, z, 6);
        break;
      case 1:
        add(u, random.uniform(0, 1) < 0.5 ? -3 : height + 2, z, 6);
        break;
      case 2:
        add(u, v, z, 0.02);
        break;
      case 3:
        add(u, v, z + 2, 0.4 * width).opacity_logit = 0;
        break;
      case 4:
        add(u, v, z, 5).opacity_logit = -5;
        break;
      case 5:
        add(u, v, z, 5).opacity_logit = 9;
        break;
      case 6:
        add(u, v, -z, 5);
        break;
      case 7:
        add(u, v, 0.12 + 0.02 * random.uniform(0, 1), 2);
        break;
      case 8: {
        auto& g = add(u, v, z, 8);
        g.log_scale[0] += 2;
        g.log_scale[1] -= 4;
        break;
      }
      default:
        add(32 * std::floor(u / 32) - 0.5, 32 * std::floor(v / 32), z, 3);
        break;
    }
  }
  s.training = training_for(s, random);
  return s;
}

std::vector<map::Gaussian> dense(const Gradients& g, std::size_t count) {
  std::vector<map::Gaussian> rows(count, map::Gaussian{});
  for (std::size_t i = 0; i < g.visible.size(); ++i) rows[g.visible[i]] = g.gradient[i];
  return rows;
}

/// Agreement up to rounding, except where rounding tips a pixel over the 1/255 cut or another jump:
/// those are few and off by at most about the cut.
void expect_images_agree(const Rendering& a, const Rendering& b) {
  ASSERT_EQ(a.alpha.size(), b.alpha.size());
  std::size_t off = 0;
  double worst = 0;
  for (std::size_t i = 0; i < a.alpha.size(); ++i) {
    const Rgbf &x = a.color.data()[i], &y = b.color.data()[i];
    const double error = std::max({std::abs(x.r - y.r), std::abs(x.g - y.g), std::abs(x.b - y.b),
                                   std::abs(a.depth_sum.data()[i] - b.depth_sum.data()[i]) / 4,
                                   std::abs(a.alpha.data()[i] - b.alpha.data()[i])});
    ASSERT_TRUE(std::isfinite(error)) << i;
    worst = std::max(worst, error);
    if (error > 1e-4) ++off;
  }
  EXPECT_LE(off, 2 + a.alpha.size() / 2000);
  EXPECT_LT(worst, 0.012);
}

/// Relative distance of one class of parameters in the Euclidean norm.
double relative_error(const std::vector<map::Gaussian>& a, const std::vector<map::Gaussian>& b,
                      std::size_t first, std::size_t count) {
  double difference = 0, size = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t k = first; k < first + count; ++k) {
      float x, y;
      std::memcpy(&x, reinterpret_cast<const char*>(&a[i]) + 4 * k, 4);
      std::memcpy(&y, reinterpret_cast<const char*>(&b[i]) + 4 * k, 4);
      difference += std::pow(double{x} - double{y}, 2);
      size += double{y} * double{y};
    }
  }
  return std::sqrt(difference / (size + 1e-12));
}

void expect_parity(const Scene& s, const LossConfig& loss, double tolerance = 2e-3) {
  auto reference = make_reference_rasterizer();
  auto fast = make_cpu_rasterizer(nullptr);
  Gradients expected, actual;
  Rendering expected_image, image;
  reference->evaluate(s.gaussians, s.training, s.pose, loss, expected, &expected_image);
  fast->evaluate(s.gaussians, s.training, s.pose, loss, actual, &image);
  expect_images_agree(image, expected_image);
  Rendering only;
  fast->render(s.gaussians, s.camera, s.pose, only);
  expect_images_agree(only, expected_image);
  EXPECT_NEAR(actual.loss, expected.loss, 1e-4 * expected.loss + 1e-3);
  const auto a = dense(actual, s.gaussians.size()), b = dense(expected, s.gaussians.size());
  EXPECT_LT(relative_error(a, b, 0, 3), tolerance) << "mean";
  EXPECT_LT(relative_error(a, b, 3, 3), tolerance) << "log_scale";
  EXPECT_LT(relative_error(a, b, 6, 4), tolerance) << "rotation";
  EXPECT_LT(relative_error(a, b, 10, 1), tolerance) << "opacity";
  EXPECT_LT(relative_error(a, b, 11, 3), tolerance) << "rgb";
  EXPECT_EQ(relative_error(a, b, 14, 2), 0) << "unused";
  EXPECT_LT((actual.camera_twist - expected.camera_twist).norm(),
            tolerance * (expected.camera_twist.norm() + 1));
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_NEAR(actual.exposure_measured[c], expected.exposure_measured[c],
                2 + 1e-3 * expected.exposure_measured[c]);
    EXPECT_NEAR(actual.exposure_rendered[c], expected.exposure_rendered[c],
                2 + 1e-3 * expected.exposure_rendered[c]);
  }
  EXPECT_TRUE(std::is_sorted(actual.visible.begin(), actual.visible.end()));
}

/// Runs its body once per instruction set that this machine has.
class EachTarget : public ::testing::TestWithParam<std::int64_t> {
 protected:
  void SetUp() override { hwy::SetSupportedTargetsForTest(GetParam()); }
  void TearDown() override { hwy::SetSupportedTargetsForTest(0); }
};

std::vector<std::int64_t> compiled_targets() {
  std::vector<std::int64_t> out;
  for (const std::int64_t t : {HWY_AVX3, HWY_AVX2, HWY_SSE4, HWY_NEON, HWY_EMU128, HWY_SCALAR}) {
    if ((hwy::SupportedTargets() & t) != 0) out.push_back(t);
  }
  return out;
}
INSTANTIATE_TEST_SUITE_P(Cpu, EachTarget, ::testing::ValuesIn(compiled_targets()),
                         [](const auto& p) { return std::string(hwy::TargetName(p.param)); });

TEST_P(EachTarget, DefaultLoss) { expect_parity(make_scene(160, 120, 250, 5, 1), {}); }

TEST_P(EachTarget, OddImageSizes) {
  expect_parity(make_scene(323, 241, 400, 6, 2), {});
  expect_parity(make_scene(33, 31, 60, 3, 3), {});
  expect_parity(make_scene(3, 2, 10, 1, 4), {});
}

TEST_P(EachTarget, RoundedResiduals) {
  LossConfig loss;
  loss.color_knee = 0.2f;
  loss.depth_knee_m = 0.05f;
  loss.gain = {1.1f, 0.9f, 1.0f};
  expect_parity(make_scene(130, 97, 200, 5, 6), loss);
}

TEST_P(EachTarget, AllTermsOfTheLoss) {
  LossConfig loss;
  loss.depth_form = DepthForm::kAbsolute;
  loss.color_only_where_depth = true;
  loss.floater_margin_m = 0.1f;
  loss.gain = {1.1f, 0.9f, 1.0f};
  const Scene s = make_scene(130, 97, 200, 5, 5);
  expect_parity(s, loss);
  loss.dssim_weight = 0.2f;
  expect_parity(s, loss);
  loss.color_weight = 0;
  loss.depth_weight = 0;
  expect_parity(s, loss, 5e-3);
}

/// The border and a hole were not seen: what stands there is arbitrary.
void hide_parts(Scene& s, float colour) {
  for (int y = 0; y < s.camera.height; ++y) {
    for (int x = 0; x < s.camera.width; ++x) {
      const bool border = x < 9 || y >= s.camera.height - 7;
      const bool hole = std::abs(x - 70) < 5 && std::abs(y - 40) < 6;
      if (!border && !hole) continue;
      s.training.depth(x, y) = TrainingImage::kUnseen;
      s.training.color(x, y) = {colour, colour, colour};
    }
  }
}

TEST_P(EachTarget, WhatWasNotSeen) {
  Scene s = make_scene(130, 97, 200, 5, 8);
  hide_parts(s, 0.3f);
  LossConfig loss;
  loss.gain = {1.1f, 0.9f, 1.0f};
  expect_parity(s, loss);
  loss.dssim_weight = 0.2f;
  expect_parity(s, loss);
  loss.color_only_where_depth = true;
  loss.floater_margin_m = 0.1f;
  loss.depth_form = DepthForm::kAbsolute;
  expect_parity(s, loss);
  loss.color_weight = 0;
  loss.depth_weight = 0;
  expect_parity(s, loss, 5e-3);
}

TEST_P(EachTarget, ColoursThatWereNotSeenChangeNothing) {
  LossConfig loss;
  loss.dssim_weight = 0.2f;
  Scene dark = make_scene(130, 97, 200, 5, 8), light = dark;
  hide_parts(dark, 0);
  hide_parts(light, 1);
  const auto fast = make_cpu_rasterizer(nullptr);
  Gradients a, b;
  fast->evaluate(dark.gaussians, dark.training, dark.pose, loss, a);
  fast->evaluate(light.gaussians, light.training, light.pose, loss, b);
  EXPECT_EQ(a.loss, b.loss);
  ASSERT_EQ(a.visible, b.visible);
  for (std::size_t i = 0; i < a.gradient.size(); ++i) {
    ASSERT_EQ(std::memcmp(&a.gradient[i], &b.gradient[i], sizeof(map::Gaussian)), 0) << i;
  }
}

TEST_P(EachTarget, NothingIsLearnedWhereNothingWasSeen) {
  Scene s = make_scene(64, 48, 60, 4, 9);
  for (std::size_t i = 0; i < s.training.depth.size(); ++i) {
    s.training.depth.data()[i] = TrainingImage::kUnseen;
  }
  LossConfig loss;
  loss.dssim_weight = 0.2f;
  Gradients gradients;
  make_cpu_rasterizer(nullptr)->evaluate(s.gaussians, s.training, s.pose, loss, gradients);
  EXPECT_NEAR(gradients.loss, 0, 1e-6);
  for (const map::Gaussian& g : gradients.gradient) {
    for (const float value : g.rgb) EXPECT_EQ(value, 0);
    for (const float value : g.mean) EXPECT_EQ(value, 0);
    EXPECT_EQ(g.opacity_logit, 0);
  }
}

TEST_P(EachTarget, EdgeCases) {
  expect_parity(make_edge_scene(150, 110, 6), {}, 2e-3);
  expect_parity(make_edge_scene(97, 64, 7), {}, 2e-3);
}

TEST_P(EachTarget, DeepTilesOfManyBatches) {
  // Thousands of faint Gaussians in one tile: more than one batch and saturation in the middle.
  Scene s{testing::small_camera(40, 30), testing::tilted_pose(), {}, {}};
  Random random(8);
  s.gaussians = testing::random_gaussians(s.camera, s.pose, 3000, 4, random);
  for (auto& g : s.gaussians) g.opacity_logit -= 3;
  s.training = training_for(s, random);
  expect_parity(s, {}, 5e-3);
}

TEST_P(EachTarget, NonsenseIsLeftOut) {
  Scene s = make_scene(100, 70, 80, 5, 9);
  Rendering clean, dirty;
  auto fast = make_cpu_rasterizer(nullptr);
  Gradients expected, actual;
  fast->evaluate(s.gaussians, s.training, s.pose, {}, expected, &clean);
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInf = std::numeric_limits<float>::infinity();
  const std::size_t sane = s.gaussians.size();
  for (const float bad : {kNan, kInf, -kInf, 1e38f, -1e38f}) {
    for (std::size_t k = 0; k < 14; ++k) {
      if (k == 10 && bad < 0) continue;  // a very transparent Gaussian is nothing special
      map::Gaussian g = s.gaussians[k];
      std::memcpy(reinterpret_cast<char*>(&g) + 4 * k, &bad, 4);
      if (k == 10 || (k >= 3 && k < 6 && bad == -1e38f)) g.rgb[0] = kNan;
      s.gaussians.push_back(g);
    }
  }
  map::Gaussian no_rotation = s.gaussians[0];
  for (float& q : no_rotation.rotation) q = 0;
  s.gaussians.push_back(no_rotation);
  fast->evaluate(s.gaussians, s.training, s.pose, {}, actual, &dirty);
  EXPECT_EQ(expected.loss, actual.loss);
  EXPECT_EQ(expected.visible, actual.visible);
  EXPECT_EQ(std::memcmp(clean.color.data(), dirty.color.data(), clean.color.size() * sizeof(Rgbf)),
            0);
  EXPECT_LE(actual.visible.back(), sane);
}

TEST_P(EachTarget, SameBitsForAnyNumberOfThreads) {
  LossConfig loss;
  loss.dssim_weight = 0.2f;
  const Scene s = make_scene(200, 150, 9000, 3, 10);
  const auto run = [&](ThreadPool* pool, Gradients& out, Rendering& image) {
    auto fast = make_cpu_rasterizer(pool);
    for (int i = 0; i < 2; ++i) fast->evaluate(s.gaussians, s.training, s.pose, loss, out, &image);
  };
  Gradients one;
  Rendering image_one;
  run(nullptr, one, image_one);
  for (const int threads : {1, 2, 3}) {
    ThreadPool pool(threads);
    Gradients many;
    Rendering image;
    run(&pool, many, image);
    EXPECT_EQ(one.loss, many.loss);
    EXPECT_EQ(one.visible, many.visible);
    EXPECT_EQ(one.camera_twist, many.camera_twist);
    EXPECT_EQ(one.exposure_rendered, many.exposure_rendered);
    EXPECT_EQ(std::memcmp(one.gradient.data(), many.gradient.data(),
                          one.gradient.size() * sizeof(map::Gaussian)),
              0);
    EXPECT_EQ(
        std::memcmp(image_one.color.data(), image.color.data(), image.color.size() * sizeof(Rgbf)),
        0);
  }
}

TEST_P(EachTarget, SinkGetsEveryRowOnce) {
  struct Collect final : GradientSink {
    std::mutex mutex;
    std::map<std::uint32_t, map::Gaussian> rows;
    void accept(std::span<const std::uint32_t> indices, const map::Gaussian* gradient) override {
      const std::scoped_lock lock(mutex);
      for (std::size_t k = 0; k < indices.size(); ++k) {
        EXPECT_TRUE(rows.emplace(indices[k], gradient[k]).second);
      }
    }
  };
  const Scene s = make_scene(200, 150, 6000, 3, 16);
  ThreadPool pool(3);
  for (auto& rasterizer : {make_cpu_rasterizer(&pool), make_reference_rasterizer()}) {
    if (rasterizer->name() == "reference" && GetParam() != compiled_targets().front()) continue;
    const auto training = rasterizer->prepare(s.training);
    Gradients expected, out;
    rasterizer->evaluate(s.gaussians, *training, s.pose, {}, expected);
    Collect sink;
    rasterizer->evaluate(s.gaussians, *training, s.pose, {}, out, {.sink = &sink});
    EXPECT_EQ(out.visible, expected.visible);
    EXPECT_TRUE(out.gradient.empty());
    EXPECT_EQ(out.camera_twist, expected.camera_twist);
    ASSERT_EQ(sink.rows.size(), expected.visible.size());
    for (std::size_t i = 0; i < expected.visible.size(); ++i) {
      EXPECT_EQ(std::memcmp(&sink.rows.at(expected.visible[i]), &expected.gradient[i], 64), 0);
    }
  }
}

/// A map all around the camera, of which little is in view.
Scene make_surroundings(std::uint64_t seed) {
  Random random(seed);
  Scene s = make_scene(160, 120, 300, 5, seed);
  for (int i = 0; i < 3000; ++i) {
    map::Gaussian g = s.gaussians[static_cast<std::size_t>(i) % 300];
    // Clusters like a keyframe's Gaussians, some of them across the borders of the view.
    const int cluster = i / 50;
    g.mean[0] = static_cast<float>(3 * std::sin(cluster) + random.uniform(-0.3, 0.3));
    g.mean[1] = static_cast<float>(std::cos(3 * cluster) + random.uniform(-0.3, 0.3));
    g.mean[2] = static_cast<float>(3 * std::cos(cluster) + random.uniform(-0.3, 0.3));
    s.gaussians.push_back(g);
  }
  return s;
}

TEST_P(EachTarget, BoundsChangeNoBit) {
  for (const double shift : {0.0, 100.0}) {
    Scene s = make_surroundings(17);
    s.pose.t.x() += shift;
    for (auto& g : s.gaussians) g.mean[0] += static_cast<float>(shift);
    map::MeanBounds bounds;
    bounds.assign(s.gaussians, s.gaussians);
    auto fast = make_cpu_rasterizer(nullptr);
    const auto training = fast->prepare(s.training);
    Gradients plain, bounded;
    fast->evaluate(s.gaussians, *training, s.pose, {}, plain);
    fast->evaluate(s.gaussians, *training, s.pose, {}, bounded, {.scope = {.bounds = &bounds}});
    EXPECT_EQ(plain.visible, bounded.visible);
    EXPECT_LT(plain.visible.size(), s.gaussians.size() / 2);
    EXPECT_EQ(plain.loss, bounded.loss);
    EXPECT_EQ(plain.camera_twist, bounded.camera_twist);
    ASSERT_EQ(plain.gradient.size(), bounded.gradient.size());
    EXPECT_EQ(std::memcmp(plain.gradient.data(), bounded.gradient.data(),
                          plain.gradient.size() * sizeof(map::Gaussian)),
              0);
  }
}

/// Options that leave something out, against the reference renderer.
void expect_parity_of_options(const Scene& s, const EvaluateOptions& options) {
  auto reference = make_reference_rasterizer();
  auto fast = make_cpu_rasterizer(nullptr);
  Gradients expected, actual;
  reference->evaluate(s.gaussians, *reference->prepare(s.training), s.pose, {}, expected, options);
  fast->evaluate(s.gaussians, *fast->prepare(s.training), s.pose, {}, actual, options);
  EXPECT_EQ(actual.visible, expected.visible);
  EXPECT_NEAR(actual.loss, expected.loss, 1e-4 * expected.loss + 1e-3);
  const auto a = dense(actual, s.gaussians.size()), b = dense(expected, s.gaussians.size());
  EXPECT_LT(relative_error(a, b, 0, 14), 2e-3);
  EXPECT_LT((actual.camera_twist - expected.camera_twist).norm(),
            2e-3 * (expected.camera_twist.norm() + 1));
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_NEAR(actual.exposure_rendered[c], expected.exposure_rendered[c],
                2 + 1e-3 * expected.exposure_rendered[c]);
  }
}

/// Two layers of nearly opaque Gaussians of which the far one is hidden for the most part.
Scene make_hidden_layer(std::uint64_t seed) {
  Random random(seed);
  Scene s{testing::small_camera(160, 120), testing::tilted_pose(), {}, {}};
  const auto add_layer = [&](double z, double u_end, float logit) {
    for (double v = 0; v < 120; v += 4) {
      for (double u = 0; u < u_end; u += 4) {
        // Equal depths would leave the order to rounding.
        const double depth = z + random.uniform(0, 0.2);
        s.gaussians.push_back(testing::gaussian_at(s.camera, s.pose, u, v, depth, 4, random));
        s.gaussians.back().opacity_logit = logit;
      }
    }
  };
  add_layer(1, 110, 3);
  add_layer(2, 160, 1);
  s.training = training_for(s, random);
  return s;
}

TEST_P(EachTarget, ReachedAreThoseWithAWeight) {
  const Scene s = make_hidden_layer(20);
  auto reference = make_reference_rasterizer();
  ThreadPool pool(3);
  auto fast = make_cpu_rasterizer(&pool);
  Gradients out;
  map::GaussianSet expected, reached, strong;
  reference->evaluate(s.gaussians, *reference->prepare(s.training), s.pose, {}, out,
                      {.capture = {.reached = &expected}});
  fast->evaluate(s.gaussians, *fast->prepare(s.training), s.pose, {}, out,
                 {.capture = {.reached = &reached}});
  const std::size_t visible = out.visible.size();
  ASSERT_EQ(reached.size(), s.gaussians.size());
  std::size_t missed = 0;
  for (std::size_t i = 0; i < s.gaussians.size(); ++i) {
    missed += expected.contains(i) && !reached.contains(i) ? 1 : 0;
  }
  EXPECT_LE(missed, 2u);  // rounding about the least transmittance
  EXPECT_LT(reached.count(), expected.count() + s.gaussians.size() / 10);
  EXPECT_LT(reached.count(), visible * 9 / 10);  // some are hidden

  constexpr float kWeight = 0.1f;
  reference->evaluate(s.gaussians, *reference->prepare(s.training), s.pose, {}, out,
                      {.capture = {.reached = &expected, .reached_weight = kWeight}});
  fast->evaluate(s.gaussians, *fast->prepare(s.training), s.pose, {}, out,
                 {.capture = {.reached = &strong, .reached_weight = kWeight}});
  EXPECT_EQ(out.visible.size(), visible);
  std::size_t different = 0;
  for (std::size_t i = 0; i < s.gaussians.size(); ++i) {
    different += expected.contains(i) != strong.contains(i) ? 1 : 0;
  }
  EXPECT_LE(different, 2u);
  EXPECT_LT(strong.count(), reached.count() * 9 / 10);
  EXPECT_GT(strong.count(), 0u);
}

TEST_P(EachTarget, CandidatesThatReachedTheImageMakeTheSameImage) {
  Scene s = make_hidden_layer(21);
  auto fast = make_cpu_rasterizer(nullptr);
  const auto training = fast->prepare(s.training);
  Gradients all, some;
  Rendering image_all, image_some;
  map::GaussianSet reached;
  fast->evaluate(s.gaussians, *training, s.pose, {}, all,
                 {.capture = {.rendering = &image_all, .reached = &reached}});
  fast->evaluate(s.gaussians, *training, s.pose, {}, some,
                 {.scope = {.candidates = &reached}, .capture = {.rendering = &image_some}});
  EXPECT_EQ(all.loss, some.loss);
  EXPECT_EQ(std::memcmp(image_all.color.data(), image_some.color.data(),
                        image_all.color.size() * sizeof(Rgbf)),
            0);
  EXPECT_EQ(some.visible.size(), reached.count());
  const auto rows = dense(all, s.gaussians.size());
  for (std::size_t k = 0; k < some.visible.size(); ++k) {
    ASSERT_EQ(std::memcmp(&rows[some.visible[k]], &some.gradient[k], sizeof rows[0]), 0) << k;
  }
}

TEST_P(EachTarget, OnlyCandidatesAndNewGaussiansAreLookedAt) {
  const Scene s = make_surroundings(22);
  map::GaussianSet candidates;
  candidates.clear(250);  // in the middle of a word; what follows is new
  for (std::size_t i = 0; i < 250; i += 3) candidates.insert(i);
  map::MeanBounds bounds;
  bounds.assign(s.gaussians, s.gaussians);
  expect_parity_of_options(s, {.scope = {.candidates = &candidates}});
  expect_parity_of_options(s, {.scope = {.bounds = &bounds, .candidates = &candidates}});
}

TEST_P(EachTarget, CandidatesMayBeReplacedByWhatTheyReached) {
  const Scene s = make_hidden_layer(24);
  auto fast = make_cpu_rasterizer(nullptr);
  const auto training = fast->prepare(s.training);
  map::GaussianSet half, reached, replaced;
  half.clear(s.gaussians.size() - 20);  // the last ones are new
  for (std::size_t i = 0; i < half.size(); i += 2) half.insert(i);
  replaced = half;
  Gradients unnoted, apart, at_once;
  fast->evaluate(s.gaussians, *training, s.pose, {}, unnoted, {.scope = {.candidates = &half}});
  fast->evaluate(
      s.gaussians, *training, s.pose, {}, apart,
      {.scope = {.candidates = &half}, .capture = {.reached = &reached, .reached_weight = 0.05f}});
  fast->evaluate(s.gaussians, *training, s.pose, {}, at_once,
                 {.scope = {.candidates = &replaced},
                  .capture = {.reached = &replaced, .reached_weight = 0.05f}});
  for (const Gradients& noted : {apart, at_once}) {
    EXPECT_EQ(noted.visible, unnoted.visible);
    EXPECT_EQ(noted.loss, unnoted.loss);
    ASSERT_EQ(noted.gradient.size(), unnoted.gradient.size());
    EXPECT_EQ(std::memcmp(noted.gradient.data(), unnoted.gradient.data(),
                          noted.gradient.size() * sizeof(map::Gaussian)),
              0);
  }
  ASSERT_EQ(replaced.size(), s.gaussians.size());
  for (std::size_t i = 0; i < s.gaussians.size(); ++i) {
    EXPECT_EQ(replaced.contains(i), reached.contains(i)) << i;
    const bool may = i >= half.size() || half.contains(i);
    EXPECT_TRUE(may || !replaced.contains(i)) << i;
  }
  EXPECT_GT(replaced.count(), 0u);
}

TEST_P(EachTarget, TrainingViewsMayStopSooner) {
  const Scene s = make_hidden_layer(23);
  expect_parity_of_options(s, {.scope = {.min_transmittance = 0.02f}});
  auto fast = make_cpu_rasterizer(nullptr);
  const auto training = fast->prepare(s.training);
  Gradients all, some;
  fast->evaluate(s.gaussians, *training, s.pose, {}, all);
  fast->evaluate(s.gaussians, *training, s.pose, {}, some, {.scope = {.min_transmittance = 0.02f}});
  EXPECT_GT(std::abs(all.loss - some.loss), 1e-3 * all.loss);  // parity would tell
}

TEST_P(EachTarget, EmptyMap) {
  Scene s = make_scene(50, 40, 10, 3, 11);
  s.gaussians.clear();
  expect_parity(s, {});
}

TEST_P(EachTarget, ImageSizeMayChangeBetweenCalls) {
  auto fast = make_cpu_rasterizer(nullptr);
  const Scene big = make_scene(160, 120, 200, 5, 12), small = make_scene(80, 60, 100, 4, 13);
  Gradients first, again, other;
  LossConfig loss;
  loss.dssim_weight = 0.1f;
  fast->evaluate(big.gaussians, big.training, big.pose, loss, first);
  fast->evaluate(small.gaussians, small.training, small.pose, loss, other);
  fast->evaluate(big.gaussians, big.training, big.pose, loss, again);
  EXPECT_EQ(first.loss, again.loss);
  EXPECT_EQ(std::memcmp(first.gradient.data(), again.gradient.data(),
                        first.gradient.size() * sizeof(map::Gaussian)),
            0);
}

TEST(CpuRasterizer, LargeImageOfReplicaSize) {
  expect_parity(make_scene(1200, 680, 300, 15, 14), {});
}

TEST(CpuRasterizer, RefusesWhatDoesNotFit) {
  auto fast = make_cpu_rasterizer(nullptr);
  const Scene s = make_scene(50, 40, 10, 3, 15);
  Gradients out;
  const auto foreign = make_reference_rasterizer()->prepare(s.training);
  EXPECT_THROW(fast->evaluate(s.gaussians, *foreign, s.pose, {}, out), ContractViolation);
  const auto own = fast->prepare(s.training);
  map::MeanBounds bounds;
  EXPECT_THROW(fast->evaluate(s.gaussians, *own, s.pose, {}, out, {.scope = {.bounds = &bounds}}),
               ContractViolation);
  map::GaussianSet set;
  set.clear(s.gaussians.size() + 1);
  EXPECT_THROW(fast->evaluate(s.gaussians, *own, s.pose, {}, out, {.scope = {.candidates = &set}}),
               ContractViolation);
  EXPECT_THROW(
      fast->evaluate(s.gaussians, *own, s.pose, {}, out, {.scope = {.min_transmittance = 0}}),
      ContractViolation);
  for (const float outside : {-0.1f, 1.0f}) {
    EXPECT_THROW(fast->evaluate(s.gaussians, *own, s.pose, {}, out,
                                {.capture = {.reached_weight = outside}}),
                 ContractViolation);
  }
  TrainingImage wrong = s.training;
  wrong.depth = DepthImage(10, 10);
  EXPECT_THROW(fast->prepare(wrong), ContractViolation);
}

}  // namespace
}  // namespace sgs::render
