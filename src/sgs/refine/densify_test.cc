// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/refine/densify.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "sgs/core/image.h"
#include "sgs/render/rasterizer.h"

namespace sgs::refine {
namespace {

map::Gaussian gaussian(float x, float sigma_m, float opacity) {
  map::Gaussian g{};
  g.mean[0] = x;
  g.mean[2] = 2;
  for (float& s : g.log_scale) s = std::log(sigma_m);
  g.log_scale[0] += 0.5f;
  g.rotation[0] = 1;
  g.opacity_logit = std::log(opacity / (1 - opacity));
  g.rgb[0] = g.rgb[1] = g.rgb[2] = 0.8f;
  return g;
}

map::GaussianStore store_of(const std::vector<map::Gaussian>& gaussians, GaussianNotes& notes) {
  map::GaussianStore store;
  for (const map::Gaussian& g : gaussians) store.append(g, {}, 10.0f);
  notes.begin(store.size());
  for (float& pixel : notes.pixel_m) pixel = 0.01f;
  return store;
}

TEST(Halves, TogetherLookLikeTheWhole) {
  const PinholeCamera camera{64, 48, 60, 60, 31.5, 23.5};
  const map::Gaussian whole = gaussian(0, 0.1f, 0.6f);
  const auto [a, b] = halves(whole);
  EXPECT_LT(a.log_scale[0], whole.log_scale[0]);
  EXPECT_NE(a.mean[0], b.mean[0]);
  const auto rasterizer = render::make_cpu_rasterizer(nullptr);
  render::Rendering before, after;
  rasterizer->render(std::vector{whole}, camera, SE3(), before);
  rasterizer->render(std::vector{a, b}, camera, SE3(), after);
  double difference = 0, sum = 0;
  for (std::size_t i = 0; i < before.alpha.size(); ++i) {
    difference += std::abs(after.alpha.data()[i] - before.alpha.data()[i]);
    sum += before.alpha.data()[i];
  }
  EXPECT_LT(difference, 0.12 * sum);
}

TEST(SplitMostPulled, SplitsThoseThatThePicturePullsAtMost) {
  GaussianNotes notes;
  LearnedHarmonics harmonics({});
  auto store =
      store_of({gaussian(0, 0.1f, 0.6f), gaussian(1, 0.1f, 0.6f), gaussian(2, 0.1f, 0.6f)}, notes);
  notes.pull = {1, 5, 2};
  EXPECT_EQ(split_most_pulled(1, 0.6, store, notes, harmonics), 1u);
  ASSERT_EQ(store.size(), 4u);
  EXPECT_NE(store.raw[1].mean[0], 1.0f);
  EXPECT_EQ(store.raw[0].mean[0], 0.0f);
  EXPECT_EQ(store.raw[2].mean[0], 2.0f);
  EXPECT_EQ(notes.pull.size(), 4u);
}

TEST(SplitMostPulled, LeavesAloneWhatIsSmallUnseenOrAtRest) {
  GaussianNotes notes;
  LearnedHarmonics harmonics({});
  auto store = store_of(
      {gaussian(0, 0.001f, 0.6f), gaussian(1, 0.1f, 0.6f), gaussian(2, 0.1f, 0.6f)}, notes);
  notes.pull = {9, 9, 0};
  notes.pixel_m[1] = kNeverSeen;
  EXPECT_EQ(split_most_pulled(3, 0.6, store, notes, harmonics), 0u);
  EXPECT_EQ(store.size(), 3u);
}

TEST(RemoveUseless, RemovesTheFaintAndTheBroken) {
  GaussianNotes notes;
  LearnedHarmonics harmonics({});
  auto store =
      store_of({gaussian(0, 0.1f, 0.01f), gaussian(1, 0.1f, 0.6f), gaussian(2, 0.1f, 0.6f)}, notes);
  notes.pull = {1, 2, 3};
  store.raw[2].mean[1] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(remove_useless(0.02, store, notes, harmonics), 2u);
  ASSERT_EQ(store.size(), 1u);
  EXPECT_EQ(store.raw[0].mean[0], 1.0f);
  EXPECT_EQ(notes.pull, std::vector<float>{2});
}

}  // namespace
}  // namespace sgs::refine
