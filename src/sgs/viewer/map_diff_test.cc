// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/viewer/map_diff.h"

#include <gmock/gmock.h>

#include <cstring>
#include <map>

#include "sgs/map/gaussian_store.h"
#include "sgs/viewer/test_update.h"

namespace sgs::viewer {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// A client that reads the bytes as docs/viewer.md says, without the structs of the encoder.
struct Decoder {
  std::map<std::uint32_t, std::array<float, 10>> splats;
  std::map<std::uint32_t, std::array<std::uint8_t, 4>> colors;
  std::map<std::uint32_t, std::string> harmonics;
  std::uint64_t version = 0;
  bool complete = false;

  template <class T>
  static T read(const std::string& m, std::size_t at) {
    T value;
    std::memcpy(&value, m.data() + at, sizeof(T));
    return value;
  }

  void apply(const std::string& m) {
    ASSERT_GE(m.size(), 24u);
    ASSERT_EQ(m[0], 1);
    if ((m[1] & 1) != 0) splats.clear();
    complete = (m[1] & 2) != 0;
    version = read<std::uint64_t>(m, 8);
    const auto n = read<std::uint32_t>(m, 16), gone = read<std::uint32_t>(m, 20);
    const std::size_t stride = 16u * static_cast<unsigned char>(m[2]);
    ASSERT_EQ(m.size(), 24 + (48ul + stride) * n + 4ul * gone);
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t at = 24 + 48 * i;
      const auto id = read<std::uint32_t>(m, at);
      splats[id] = read<std::array<float, 10>>(m, at + 4);
      colors[id] = read<std::array<std::uint8_t, 4>>(m, at + 44);
      harmonics[id] = m.substr(24 + 48ul * n + 4ul * gone + stride * i, stride);
    }
    for (std::size_t i = 0; i < gone; ++i) {
      ASSERT_EQ(splats.erase(read<std::uint32_t>(m, 24 + 48ul * n + 4 * i)), 1u);
    }
  }
  void apply(const MapStep& step) {
    for (std::size_t i = 0; i < map_message_count(step); ++i) apply(map_message(step, i));
  }
};

TEST(MapDiff, TheRecordSaysWhatTheGaussianIs) {
  map::Gaussian g = testing::gaussian(3);
  g.rgb[1] = 7;                                        // over-exposed
  g.rgb[2] = std::numeric_limits<float>::quiet_NaN();  // broken
  const SplatRecord r = encode_splat(g, 9);
  EXPECT_EQ(r.id, 9u);
  EXPECT_EQ(r.position[0], 3);
  EXPECT_FLOAT_EQ(r.scale[1], 0.1f);
  EXPECT_FLOAT_EQ(r.rotation[0], 1);
  EXPECT_THAT(r.rgba, ElementsAre(128, 255, 0, 186));  // 255 * sigmoid(1)
}

TEST(MapDiff, HarmonicsGoAlong) {
  const auto first = testing::snapshot(1, {0, 1, 2});
  first->harmonics.degree = 1;
  first->harmonics.resize(3);
  first->harmonics.of(1)[4] = 0.5f;
  Decoder client;
  const MapStep start = map_step(nullptr, *first, false);
  client.apply(start);
  ASSERT_EQ(client.harmonics[1].size(), 16u);
  EXPECT_EQ(static_cast<unsigned char>(client.harmonics[1][4]), 192);
  EXPECT_EQ(static_cast<unsigned char>(client.harmonics[0][4]), 128);

  const auto second = testing::snapshot(2, {0, 1, 2});
  second->harmonics = first->harmonics;
  second->harmonics.of(0)[0] = 0.01f;  // nobody sees that
  second->harmonics.of(2)[8] = -0.5f;
  const MapStep step = map_step(start.to, *second, false);
  EXPECT_FALSE(step.reset);
  EXPECT_THAT(step.changed, ElementsAre(2));
  client.apply(step);
  EXPECT_EQ(static_cast<unsigned char>(client.harmonics[2][8]), 64);
  EXPECT_THAT(map_step(step.to, *second, true).changed, ElementsAre(0));
  EXPECT_TRUE(map_step(step.to, *testing::snapshot(3, {0, 1, 2}), false).reset);
}

TEST(MapDiff, StepsLeadAClientToTheSnapshot) {
  Decoder client;
  const auto first = testing::snapshot(1, {0, 1, 2, 3, 5});
  const MapStep start = map_step(nullptr, *first, false);
  EXPECT_TRUE(start.reset);
  client.apply(start);
  EXPECT_EQ(client.splats.size(), 5u);

  auto second = testing::snapshot(2, {0, 2, 5, 6, 8});
  second->gaussians[1].mean[1] = 1;
  const MapStep step = map_step(start.to, *second, false);
  EXPECT_FALSE(step.reset);
  EXPECT_THAT(step.changed, ElementsAre(1, 3, 4));
  EXPECT_THAT(step.removed, ElementsAre(1, 3));
  client.apply(step);
  EXPECT_EQ(client.version, 2u);
  EXPECT_TRUE(client.complete);
  ASSERT_EQ(client.splats.size(), 5u);
  for (std::size_t i = 0; i < 5; ++i) {
    const std::uint32_t id = second->anchors[i].id;
    const SplatRecord want = encode_splat(second->gaussians[i], id);
    EXPECT_EQ(std::memcmp(client.splats.at(id).data(), want.position, 40), 0) << id;
    EXPECT_EQ(std::memcmp(client.colors.at(id).data(), want.rgba, 4), 0) << id;
  }
}

TEST(MapDiff, SmallStepsAreHeldBackUntilTheyAddUp) {
  auto snapshot = testing::snapshot(1, {4});
  ClientMapPtr has = map_step(nullptr, *snapshot, false).to;
  int sent = 0;
  for (int i = 0; i < 10; ++i) {
    snapshot->gaussians[0].mean[0] += 0.001f;  // a hundredth of its size
    const MapStep step = map_step(has, *snapshot, false);
    sent += step.changed.empty() ? 0 : 1;
    has = step.to;
  }
  EXPECT_EQ(sent, 2);  // after 5 and 10 hundredths
  snapshot->gaussians[0].mean[0] += 0.001f;
  const MapStep exact = map_step(has, *snapshot, true);
  EXPECT_THAT(exact.changed, ElementsAre(0));
  EXPECT_THAT(map_step(exact.to, *snapshot, true).changed, IsEmpty());
}

TEST(MapDiff, EveryKindOfVisibleChangeIsSent) {
  const auto base = testing::snapshot(1, {4});
  const ClientMapPtr has = map_step(nullptr, *base, false).to;
  const auto changes = [&](auto&& edit) {
    map::Snapshot next = *base;
    edit(next.gaussians[0]);
    return map_step(has, next, false).changed.size() == 1;
  };
  EXPECT_FALSE(changes([](map::Gaussian&) {}));
  EXPECT_FALSE(changes([](map::Gaussian& g) { g.rotation[0] = 1; }));  // only its length
  EXPECT_TRUE(changes([](map::Gaussian& g) { g.mean[2] += 0.01f; }));
  EXPECT_TRUE(changes([](map::Gaussian& g) { g.mean[2] = NAN; }));
  EXPECT_TRUE(changes([](map::Gaussian& g) { g.log_scale[1] += 0.1f; }));
  EXPECT_TRUE(changes([](map::Gaussian& g) { g.rotation[1] = 0.2f; }));
  EXPECT_TRUE(changes([](map::Gaussian& g) { g.opacity_logit = 2; }));
  EXPECT_TRUE(changes([](map::Gaussian& g) { g.rgb[1] = 0.02f; }));
}

TEST(MapDiff, LargeMapsComeInBoundedMessages) {
  std::vector<std::uint32_t> ids(2 * kMapMessageRecords + 10);
  for (std::size_t i = 0; i < ids.size(); ++i) ids[i] = static_cast<std::uint32_t>(i);
  const MapStep all = map_step(nullptr, *testing::snapshot(1, ids), false);
  ASSERT_EQ(map_message_count(all), 3u);
  Decoder client;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::string message = map_message(all, i);
    EXPECT_LE(message.size(), 24 + 48 * kMapMessageRecords);
    client.apply(message);
    EXPECT_EQ(client.complete, i == 2);
  }
  EXPECT_EQ(client.splats.size(), ids.size());
  client.apply(map_step(all.to, *testing::snapshot(2, {}), false));
  EXPECT_THAT(client.splats, IsEmpty());
}

TEST(MapDiff, WithoutRisingIdsTheClientStartsAgain) {
  const ClientMapPtr has = map_step(nullptr, *testing::snapshot(1, {1, 2}), false).to;
  const MapStep step = map_step(has, *testing::snapshot(2, {2, 2, 1}), false);
  EXPECT_TRUE(step.reset);
  Decoder client;
  client.apply(step);
  EXPECT_EQ(client.splats.size(), 3u);
}

TEST(MapDiff, TheStoreGivesIdsThatSurvivePruning) {
  map::GaussianStore store;
  for (int i = 0; i < 4; ++i) store.append(testing::gaussian(0), {}, 0);
  store.remove_if([](std::size_t i) { return i == 1 || i == 3; });
  store.append(testing::gaussian(0), {}, 0);
  std::vector<std::uint32_t> ids;
  for (const map::Anchor& anchor : store.anchors) ids.push_back(anchor.id);
  EXPECT_THAT(ids, ElementsAre(0, 2, 4));
}

}  // namespace
}  // namespace sgs::viewer
