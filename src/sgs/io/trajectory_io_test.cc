// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/io/trajectory_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sgs/io/atomic_file.h"
#include "sgs/io/temporary_folder.h"

namespace sgs::io {
namespace {

using testing::HasSubstr;

TEST(TrajectoryIo, RoundTripKeepsNineDigits) {
  const TemporaryFolder folder;
  Trajectory trajectory;
  for (int i = 0; i < 20; ++i) {
    Vector6d xi;
    xi << 0.3 * i, -0.1 * i, 0.2, 1.5 * i, -2, 0.123456789;
    trajectory.push_back({1305031102.175304 + i / 30.0, SE3::exp(xi)});
  }
  ASSERT_TRUE(save_trajectory(folder / "t.txt", trajectory));
  const auto back = load_trajectory(folder / "t.txt");
  ASSERT_TRUE(back) << back.error().text();
  ASSERT_EQ(back->trajectory.size(), 20u);
  EXPECT_EQ(back->warning, "");
  for (std::size_t i = 0; i < 20; ++i) {
    const auto &a = trajectory.poses()[i], &b = back->trajectory.poses()[i];
    EXPECT_NEAR(a.timestamp_s, b.timestamp_s, 1e-6);
    EXPECT_LT((a.T_world_camera.inverse() * b.T_world_camera).log().norm(), 1e-8);
  }
}

TEST(TrajectoryIo, TextIsExactlyAsDocumented) {
  Trajectory trajectory;
  trajectory.push_back({1.5, SE3(Eigen::Matrix3d::Identity(), {1, -2, 0.25})});
  EXPECT_EQ(trajectory_text(trajectory),
            "1.500000000 1.000000000 -2.000000000 0.250000000 0.000000000 0.000000000 0.000000000 "
            "1.000000000\n");
}

TEST(TrajectoryIo, CommentsBlankLinesAndBadRows) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_file(folder / "t.txt",
                         "# a comment\n"
                         "\n"
                         "3 0 0 3 0 0 0 1\r\n"
                         "1 0 0 1 0 0 0 1.005  # nearly unit\n"
                         "2 nan 0 0 0 0 0 1\n"
                         "4 0 0 0 0 0 0 0\n"
                         "5 0 0 0 0 0 0 1.02\n"
                         "6 0 inf 0 0 0 0 1\n"
                         "3 0 0 9 0 0 0 1\n"));
  const auto loaded = load_trajectory(folder / "t.txt");
  ASSERT_TRUE(loaded) << loaded.error().text();
  EXPECT_EQ(loaded->rows, 7u);
  EXPECT_EQ(loaded->skipped, 4u);
  EXPECT_EQ(loaded->out_of_order, 1u);
  EXPECT_EQ(loaded->duplicates, 1u);
  ASSERT_EQ(loaded->trajectory.size(), 2u);
  EXPECT_EQ(loaded->trajectory.poses()[0].T_world_camera.t.z(), 1);
  EXPECT_EQ(loaded->trajectory.poses()[1].T_world_camera.t.z(), 3);  // the first of the two
  EXPECT_TRUE(loaded->trajectory.poses()[0].T_world_camera.R.isIdentity(1e-12));
  EXPECT_THAT(loaded->warning, HasSubstr("4 rows with NaN"));
}

TEST(TrajectoryIo, MalformedRowsNameFileAndLine) {
  const TemporaryFolder folder;
  for (const char* row : {"1 2 3", "1 0 0 0 0 0 0 1 9", "1 0 0 zero 0 0 0 1", "1 0 0 0 0 0 0 1x"}) {
    ASSERT_TRUE(write_file(folder / "t.txt", fmt::format("# head\n0 0 0 0 0 0 0 1\n{}\n", row)));
    const auto loaded = load_trajectory(folder / "t.txt");
    ASSERT_FALSE(loaded) << row;
    EXPECT_THAT(loaded.error().message, HasSubstr("t.txt:3"));
  }
  EXPECT_EQ(load_trajectory(folder / "none.txt").error().code, ErrorCode::kNotFound);
}

TEST(TrajectoryIo, FullDiskIsReported) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  Trajectory trajectory;
  trajectory.push_back({0, SE3{}});
  EXPECT_FALSE(save_trajectory("/dev/full", trajectory));
}

TEST(TrajectoryIo, AHeadingSaysTheOrderOfTheColumns) {
  const auto named = trajectory_from_text(
      "num,t,x,y,z,qw,qx,qy,qz\n0,1.5,1,2,3,1,0,0,0\n1,2.5,4,5,6,1,0,0,0\n", "a.csv");
  ASSERT_TRUE(named) << named.error().text();
  ASSERT_EQ(named->trajectory.size(), 2u);
  EXPECT_EQ(named->trajectory.poses()[1].timestamp_s, 2.5);
  EXPECT_EQ(named->trajectory.poses()[1].T_world_camera.t, Eigen::Vector3d(4, 5, 6));
  EXPECT_TRUE(named->trajectory.poses()[1].T_world_camera.R.isIdentity());
  const auto commas = trajectory_from_text("1,5 1,0 2,0 3,0 0,0 0,0 0,0 1,0\n", "a.txt");
  ASSERT_TRUE(commas) << commas.error().text();
  EXPECT_EQ(commas->trajectory.poses()[0].timestamp_s, 1.5);
}

TEST(TrajectoryIo, WhatIsNoPoseIsShownWhole) {
  const std::string kitti = "1 0 0 0.5 0 1 0 0.25 0 0 1 0.125";
  const auto read = trajectory_from_text(kitti + "\n", "poses.txt");
  ASSERT_FALSE(read);
  EXPECT_NE(read.error().message.find(kitti), std::string::npos);
  EXPECT_NE(read.error().remedy.find("eight numbers"), std::string::npos);
}

}  // namespace
}  // namespace sgs::io
