// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/registration/target_shortlist.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "sgs/registration/correspondence_search.h"

namespace sgs::registration {
namespace {

constexpr int kWidth = 82, kHeight = 62;  // cells
const CellCamera kCells{70, 70, 41, 31, 0.05f};

/// Adds a wall facing the camera at depth z, a point every 2 cm.
void add_wall(TargetCloud& cloud, float half_width_m, float z) {
  for (float y = -0.5f; y < 0.5f; y += 0.02f) {
    for (float x = -half_width_m; x < half_width_m; x += 0.02f) {
      cloud.points.push_back({{x, y, z}, {0, 0, -1}, 1e-6f});
    }
  }
}

SE3 shifted(double x) {
  SE3 T;
  T.t.x() = x;
  return T;
}

SE3 turned(double rad) {
  SE3 T;
  T.R = Eigen::AngleAxisd(rad, Eigen::Vector3d::UnitY()).toRotationMatrix();
  return T;
}

TEST(TargetShortlist, LeavesOutWhatIsCoveredBehindOrTurnedAway) {
  TargetCloud cloud;
  add_wall(cloud, 2, 1.5f);
  const std::size_t front = cloud.points.size();
  add_wall(cloud, 0.2f, 2.5f);                                    // covered
  cloud.points.push_back({{0, 0, 1}, {0, 0, 1}, 1e-6f});          // back side
  cloud.points.push_back({{0, 0, -1}, {0, 0, -1}, 1e-6f});        // behind the camera
  cloud.points.push_back({{0, 0, 1}, {0, 0, -1}, 0});             // removed
  cloud.points.push_back({{0.3f, 0, 1.52f}, {0, 0, -1}, 1e-6f});  // noise, hardly behind
  TargetShortlist list(kCells, kWidth, kHeight);
  list.update(cloud, SE3{});
  ASSERT_FALSE(list.indices().empty());
  EXPECT_EQ(list.indices().size(), list.targets().size());
  EXPECT_TRUE(std::is_sorted(list.indices().begin(), list.indices().end()));
  EXPECT_EQ(list.indices().back(), static_cast<int>(cloud.points.size()) - 1);
  EXPECT_LT(list.indices()[list.indices().size() - 2], static_cast<int>(front));
}

TEST(TargetShortlist, LooksAgainWhenTheCameraMovedOrTargetsDid) {
  TargetCloud cloud;
  add_wall(cloud, 2, 1.5f);
  TargetShortlist list(kCells, kWidth, kHeight);
  list.update(cloud, SE3{});
  list.update(cloud, shifted(0.02));
  list.update(cloud, turned(0.02));
  EXPECT_EQ(list.looks(), 1);
  list.update(cloud, shifted(0.08));
  EXPECT_EQ(list.looks(), 2);
  list.update(cloud, turned(0.1));
  EXPECT_EQ(list.looks(), 3);
  ++cloud.moves;
  list.update(cloud, turned(0.1));
  EXPECT_EQ(list.looks(), 4);
  cloud.points.resize(10);
  ++cloud.layout;
  list.update(cloud, turned(0.1));
  EXPECT_EQ(list.looks(), 5);
}

TEST(TargetShortlist, ForgetsRemovedTargetsAtOnce) {
  TargetCloud cloud;
  add_wall(cloud, 2, 1.5f);
  TargetShortlist list(kCells, kWidth, kHeight);
  list.update(cloud, SE3{});
  const std::vector<int> before = list.indices();
  const auto remove = [&](int i) {
    cloud.points[static_cast<std::size_t>(i)].variance_m2 = 0;
    cloud.removed.push_back(i);
  };
  remove(before[3]);
  remove(before[7]);
  list.update(cloud, SE3{});
  EXPECT_EQ(list.looks(), 2);
  std::vector<int> expected = before;
  expected.erase(expected.begin() + 7);
  expected.erase(expected.begin() + 3);
  EXPECT_EQ(list.indices(), expected);
  list.update(cloud, SE3{});
  EXPECT_EQ(list.looks(), 2);
}

TEST(TargetShortlist, ListsNewTargetsAtOnce) {
  TargetCloud cloud;
  add_wall(cloud, 2, 1.5f);
  TargetShortlist list(kCells, kWidth, kHeight);
  list.update(cloud, SE3{});
  const std::size_t before = list.indices().size();
  cloud.points.push_back({{0, 0, 1}, {0, 0, -1}, 1e-6f});
  list.update(cloud, SE3{});
  EXPECT_EQ(list.looks(), 1);
  ASSERT_EQ(list.indices().size(), before + 1);
  EXPECT_EQ(list.indices().back(), static_cast<int>(cloud.points.size()) - 1);
}

TEST(TargetShortlist, FindsTheSameTargetsAsAFreshSearchAlongASmoothPath) {
  TargetCloud cloud;
  add_wall(cloud, 0.3f, 1.0f);  // covers a part of the next
  add_wall(cloud, 3, 1.6f);
  add_wall(cloud, 3, 3.0f);
  const PinholeCamera camera{320, 240, 270, 268, 159.3, 121.1};
  const auto search = make_search(SearchConfig{}, camera);
  std::size_t all = 0, same = 0;
  for (int frame = 0; frame < 40; ++frame) {
    const SE3 T = shifted(0.011 * frame) * turned(0.008 * frame);
    const auto fresh = make_search(SearchConfig{}, camera);
    search->prepare(cloud, T);
    fresh->prepare(cloud, T);
    all += fresh->targets().size();
    for (const TargetPoint& target : fresh->targets()) {
      const auto is_it = [&](const TargetPoint& other) { return other.point == target.point; };
      same += std::ranges::any_of(search->targets(), is_it) ? 1 : 0;
    }
  }
  EXPECT_GT(all, 40u * 1000);
  EXPECT_GT(static_cast<double>(same), 0.995 * static_cast<double>(all));
}

}  // namespace
}  // namespace sgs::registration
