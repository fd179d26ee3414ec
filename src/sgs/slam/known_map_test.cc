// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/slam/known_map.h"

#include <gmock/gmock.h>

#include <cmath>

#include "sgs/mapper/test_wall_scene.h"
#include "sgs/slam/session.h"

namespace sgs::slam {
namespace {

using ::testing::ElementsAre;

TEST(KnownMap, GaussiansGoWithTheViewOfTheirSessionNextToTheirBirth) {
  KnownMap map;
  map.sessions = 2;
  map.session_of = {0, 0, 1, 1};
  map.births = {{0, 10.1}, {0, 11.9}, {0, 99}, {1, 0}, {1, 11.9}, {0, NAN}, {7, 3}};
  EXPECT_THAT(views_of_gaussians(map, {10, 12, 11, 13}), ElementsAre(0, 1, 1, 2, 2, 0, 0));
}

// A map of one view and one Gaussian, given to a session that has to find itself there first.
TEST(KnownMap, IsThereFromTheBeginningAndKeepsItsBirths) {
  const auto config = [] {
    auto c = *make_session_config("default");
    c.backend.calibration.online = false;
    return c;
  }();
  const auto wall = mapper::wall_frame(mapper::small_camera(), SE3{});
  auto snapshot = std::make_shared<map::Snapshot>();
  map::Gaussian g{};
  g.mean[2] = 2;
  g.rotation[0] = 1;
  snapshot->gaussians.push_back(g);
  KnownMap map;
  map.gaussians = snapshot;
  map.views = 1;
  map.view = [&](std::size_t) -> Result<alignment::KnownView> {
    alignment::KnownView view;
    view.timestamp_s = 5;
    view.frame = *wall;
    view.ferns = features::Ferns(3).code(*wall);
    view.fern_seed = 3;
    return view;
  };
  map.births = {{0, 4.5}};
  map.session_of = {0};
  SessionOptions options;
  options.threads = 1;
  auto session = Session::create(config, wall->camera, options);
  ASSERT_TRUE(session);
  ASSERT_TRUE((*session)->go_on_with(map));
  ASSERT_NE((*session)->snapshot(), nullptr);
  EXPECT_EQ((*session)->snapshot()->gaussians.size(), 1u);
  EXPECT_FALSE((*session)->has_place());
  EXPECT_FALSE((*session)->can_be_saved());
  // A wall of another world: nothing is learned from it.
  auto other = std::make_shared<RgbdFrame>(*wall);
  for (std::size_t i = 0; i < other->color.size(); ++i) other->color.data()[i] = {90, 90, 90};
  (*session)->feed(other);
  (*session)->finish();
  EXPECT_EQ((*session)->final_snapshot()->gaussians.size(), 1u);
  EXPECT_EQ((*session)->iterations(), 0);
  EXPECT_TRUE((*session)->trajectory().poses().empty());
  EXPECT_TRUE((*session)->keyframe_trajectory().poses().empty());
  const auto births = births_of(**session, *(*session)->final_snapshot());
  ASSERT_EQ(births.size(), 1u);
  EXPECT_EQ(births[0].session, 0);
  EXPECT_EQ(births[0].time_s, 4.5);
  EXPECT_THAT(sessions_of_views(**session), ElementsAre(0));
  const auto view = known_view(**session, (*session)->trajectory(), 0);
  EXPECT_EQ(view.timestamp_s, 5);
  EXPECT_EQ(view.fern_seed, 3u);
}

}  // namespace
}  // namespace sgs::slam
