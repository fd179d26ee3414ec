// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/mapper/optimizer.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sgs/render/instruction_set.h"

namespace sgs::mapper {
namespace {

map::Gaussian row(float value) {
  map::Gaussian g{};
  for (float* p : {g.mean, g.log_scale, g.rgb}) {
    for (int k = 0; k < 3; ++k) p[k] = value;
  }
  for (float& q : g.rotation) q = value;
  g.opacity_logit = value;
  return g;
}

void step(const Optimizer& optimizer, const std::vector<std::uint32_t>& indices,
          const std::vector<map::Gaussian>& gradient, map::GaussianStore& store) {
  optimizer.step(indices, gradient.data(), store);
}

/// Runs its body once per instruction set that this machine has.
class EachInstructionSet : public ::testing::TestWithParam<std::string> {
 protected:
  void SetUp() override { ASSERT_TRUE(render::use_instruction_set(GetParam())); }
  void TearDown() override { ASSERT_TRUE(render::use_instruction_set("best")); }
};
INSTANTIATE_TEST_SUITE_P(Cpu, EachInstructionSet, ::testing::ValuesIn(render::instruction_sets()),
                         [](const auto& p) { return p.param; });

TEST_P(EachInstructionSet, FollowsTheScalarFormulaOfAdam) {
  OptimizerConfig config;
  config.average = 0.9;
  map::GaussianStore store;
  store.append(row(1), {}, 1e6f);
  const Optimizer optimizer(config);
  // Moments of 8 bits: a step is off by up to half a percent of the rate, either way.
  const double tolerance = 30 * 0.002 * config.rate_color;
  double value = 1, m = 0, v = 0, average = 1;
  for (int t = 1; t <= 30; ++t) {
    const double g = std::sin(0.7 * t);
    step(optimizer, {0}, {row(static_cast<float>(g))}, store);
    m = 0.9 * m + 0.1 * g;
    v = config.beta2 * v + (1 - config.beta2) * g * g;
    value -= config.rate_color * (m / (1 - std::pow(0.9, t))) /
             std::sqrt(v / (1 - std::pow(config.beta2, t)));
    if (t >= 16 && t % 4 != 0) continue;
    const double d = std::pow(std::min(0.9, static_cast<double>(t) / (t + 9)), t < 16 ? 1 : 4);
    average = d * average + (1 - d) * value;
  }
  EXPECT_NEAR(store.raw[0].rgb[1], value, tolerance);
  EXPECT_NEAR(store.average[0].rgb[1], average, tolerance);
  EXPECT_EQ(store.steps[0], 30u);
  EXPECT_EQ(store.raw[0].unused[0], 0.0f);
}

TEST_P(EachInstructionSet, LongMemoriesDoNotStandStill) {
  // With beta2 = 0.999 a second moment changes by less than the last digit of its 8 bits. After the
  // gradients have become ten times smaller it must follow, or the steps stay ten times too short.
  OptimizerConfig config;
  config.beta2 = 0.999;
  map::GaussianStore store;
  store.append(row(0), {}, 1e6f);
  const Optimizer optimizer(config);
  for (int t = 0; t < 500; ++t) step(optimizer, {0}, {row(1)}, store);
  for (int t = 0; t < 12000; ++t) step(optimizer, {0}, {row(0.1f)}, store);
  const float before = store.raw[0].rgb[0];
  step(optimizer, {0}, {row(0.1f)}, store);
  EXPECT_NEAR(before - store.raw[0].rgb[0], config.rate_color, 0.05 * config.rate_color);
  EXPECT_NEAR(store.average[0].rgb[0], before, 100 * config.rate_color);
}

TEST_P(EachInstructionSet, NoAverageMeansTheValueItself) {
  OptimizerConfig config;
  config.average = 0;
  map::GaussianStore store;
  store.append(row(1), {}, 1e6f);
  const Optimizer optimizer(config);
  for (int t = 0; t < 23; ++t) {
    step(optimizer, {0}, {row(1)}, store);
    EXPECT_NEAR(store.average[0].rgb[0], store.raw[0].rgb[0], 1e-6) << t;
  }
}

TEST_P(EachInstructionSet, TouchesOnlyVisibleGaussians) {
  map::GaussianStore store;
  for (int i = 0; i < 3; ++i) store.append(row(1), {}, 1e6f);
  step(Optimizer({}), {1}, {row(1)}, store);
  EXPECT_EQ(store.raw[0].rgb[0], 1.0f);
  EXPECT_LT(store.raw[1].rgb[0], 1.0f);
  EXPECT_EQ(store.raw[2].rgb[0], 1.0f);
  EXPECT_EQ(store.steps[2], 0u);
}

TEST_P(EachInstructionSet, CapsNeedlesAndGrowth) {
  map::GaussianStore store;
  map::Gaussian g = row(0);
  g.log_scale[0] = 2;
  g.log_scale[1] = -1;
  g.log_scale[2] = -3;
  store.append(g, {}, 1e6f);
  store.append(g, {}, -2.0f);
  step(Optimizer({}), {0, 1}, {row(0), row(0)}, store);
  EXPECT_NEAR(store.raw[0].log_scale[0], -1 + std::log(2.5), 1e-5);
  EXPECT_NEAR(store.raw[1].log_scale[0], -2, 1e-5);
  EXPECT_NEAR(store.raw[1].log_scale[1], -2, 1e-5);
}

TEST_P(EachInstructionSet, KeepsPlatesThickEnoughNotToShowAsNeedles) {
  map::Gaussian g = row(0);
  g.log_scale[0] = -3;
  g.log_scale[1] = -9;
  g.log_scale[2] = -2.5f;
  for (const double flatness : {4.0, 0.0}) {
    map::GaussianStore store;
    store.append(g, {}, 1e6f);
    OptimizerConfig config;
    config.max_flatness = flatness;
    step(Optimizer(config), {0}, {row(0)}, store);
    EXPECT_NEAR(store.raw[0].log_scale[0], -3, 1e-5);
    EXPECT_NEAR(store.raw[0].log_scale[1], flatness > 0 ? -3 - std::log(4.0) : -9, 1e-5);
    EXPECT_NEAR(store.raw[0].log_scale[2], -2.5, 1e-5);
  }
}

TEST_P(EachInstructionSet, TakesTinyAndHugeGradients) {
  // Steps of Adam do not depend on the gradient's size; a gradient of zero moves nothing.
  const OptimizerConfig config;
  for (const float size : {1e-9f, 1e6f, 0.0f}) {
    map::GaussianStore store;
    store.append(row(1), {}, 1e6f);
    step(Optimizer(config), {0}, {row(size)}, store);
    EXPECT_NEAR(store.raw[0].rgb[0], size > 0 ? 1 - config.rate_color : 1, 1e-6);
    EXPECT_NEAR(store.raw[0].opacity_logit, size > 0 ? 1 - config.rate_opacity : 1, 1e-5);
  }
}

TEST(GaussianStore, RemovesInOrder) {
  map::GaussianStore store;
  for (int i = 0; i < 6; ++i) store.append(row(static_cast<float>(i)), {}, static_cast<float>(i));
  EXPECT_EQ(store.remove_if([](std::size_t i) { return i % 3 == 0; }), 2u);
  ASSERT_EQ(store.size(), 4u);
  const float expected[] = {1, 2, 4, 5};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(store.raw[i].rgb[0], expected[i]);
    EXPECT_EQ(store.max_log_scale[i], expected[i]);
  }
  EXPECT_EQ(store.anchors.size(), 4u);
  EXPECT_EQ(store.moments.size(), 4u);
}

}  // namespace
}  // namespace sgs::mapper
