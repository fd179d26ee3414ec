// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/robot/news.h"

#include <gtest/gtest.h>

namespace sgs::robot {
namespace {

std::string all_kinds() {
  Standing standing;
  standing.T_map_odom.t = {1, 2, 3};
  standing.velocity = Vector6d::Constant(0.5);
  Trajectory path;
  path.push_back({1.5, SE3(Eigen::Matrix3d::Identity(), {4, 5, 6})});
  path.push_back({2.5, SE3{}});
  occupancy::OccupancyGrid grid;
  grid.resolution_m = 0.05;
  grid.origin_m = {-1, -2};
  grid.width = 2;
  grid.height = 1;
  grid.cells = {occupancy::Cell::kFree, occupancy::Cell::kOccupied};
  return encode(PoseNews{7.25, standing}) + encode(PathNews{8, path}) +
         encode(CloudNews{9, {{{1, 2, 3}, {10, 20, 30}}}}) + encode(GridNews{10, grid});
}

TEST(News, ComeThroughInPiecesOfAnySize) {
  const std::string bytes = all_kinds();
  for (const std::size_t piece : {std::size_t{1}, std::size_t{7}, bytes.size()}) {
    NewsParser parser;
    std::vector<News> came;
    News news;
    for (std::size_t at = 0; at < bytes.size(); at += piece) {
      parser.push(std::string_view(bytes).substr(at, piece));
      while (parser.next(news).value()) came.push_back(news);
    }
    ASSERT_EQ(came.size(), 4u);
    EXPECT_TRUE(parser.between_news());
    const auto& pose = std::get<PoseNews>(came[0]);
    EXPECT_EQ(pose.timestamp_s, 7.25);
    EXPECT_EQ(pose.standing.T_map_odom.t, Eigen::Vector3d(1, 2, 3));
    EXPECT_EQ(pose.standing.velocity.value()[5], 0.5);
    EXPECT_EQ(std::get<PathNews>(came[1]).poses.poses()[0].T_world_camera.t.x(), 4);
    EXPECT_EQ(std::get<CloudNews>(came[2]).points[0].color.b, 30);
    EXPECT_EQ(std::get<GridNews>(came[3]).grid.cells[1], occupancy::Cell::kOccupied);
  }
}

TEST(News, AreRefusedWhereTheyAreNone) {
  std::string cut = encode(CloudNews{9, {{{1, 2, 3}, {10, 20, 30}}}});
  cut.pop_back();
  --cut[1];
  std::string other = all_kinds();
  other[0] = 'X';
  for (const std::string& bytes : {cut, other}) {
    NewsParser parser;
    parser.push(bytes);
    News news;
    EXPECT_FALSE(parser.next(news).has_value());
  }
}

}  // namespace
}  // namespace sgs::robot
