// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/history/path.h"

#include <gtest/gtest.h>

#include <thread>

#include "sgs/core/error.h"

namespace sgs::history {
namespace {

SE3 at(double x) { return {Eigen::Matrix3d::Identity(), {x, 0, 0}}; }

Path path_of(std::int64_t first, std::int64_t step, int count) {
  Path path;
  for (int k = 0; k < count; ++k) path.append({first + k * step, 0.1 * k, at(k)});
  return path;
}

TEST(Path, FindsFramesWhereverSomeWereLeftOut) {
  Path path = path_of(7, 1, 300);
  path.append({310, 31, at(300)});
  for (std::int64_t frame = 400; frame < 900; frame += 3) path.append({frame, 40, at(0.5)});
  EXPECT_EQ(path.size(), 300u + 1 + 167);
  EXPECT_EQ(path.at(7).t.x(), 0);
  EXPECT_EQ(path.at(306).t.x(), 299);
  EXPECT_EQ(path.at(310).t.x(), 300);
  for (std::size_t k = 0; k < path.size(); ++k) {
    EXPECT_EQ(path.find(path[k].frame), &path[k]) << path[k].frame;
  }
  for (const std::int64_t missing : {-1, 6, 307, 311, 401, 899, 5000}) {
    EXPECT_FALSE(path.contains(missing)) << missing;
  }
  EXPECT_FALSE(Path().contains(0));
  EXPECT_THROW((void)path.at(308), ContractViolation);
}

TEST(Path, CopiesStayAsTheyAre) {
  for (const int count : {0, 1, 255, 256, 257, 700}) {
    Path path = path_of(0, 1, count);
    const Path copy = path;
    Path other = path;
    path.append({1000, 70, at(-1)});
    other.append({1001, 70, at(-2)});
    EXPECT_EQ(copy.size(), static_cast<std::size_t>(count));
    EXPECT_FALSE(copy.contains(1000));
    EXPECT_EQ(path.back().frame, 1000) << count;
    EXPECT_EQ(other.back().frame, 1001) << count;
    EXPECT_EQ(path.size(), other.size());
    if (count == 0) continue;
    EXPECT_EQ(other.at(count - 1).t.x(), count - 1);
  }
}

TEST(Path, FramesComeInOrder) {
  Path path = path_of(3, 1, 2);
  EXPECT_THROW(path.append({4, 1, at(0)}), ContractViolation);
}

TEST(Path, IsMovedAsAWhole) {
  const Path path = path_of(0, 1, 400);
  const Path moved = path.moved(PoseCorrection({{0, {}, at(1)}, {39.9, {}, at(1)}}));
  ASSERT_EQ(moved.size(), path.size());
  for (std::size_t k = 0; k < path.size(); ++k) {
    EXPECT_NEAR(moved[k].T_odom_camera.t.x(), path[k].T_odom_camera.t.x() + 1, 1e-9);
    EXPECT_EQ(moved[k].frame, path[k].frame);
    EXPECT_EQ(path[k].T_odom_camera.t.x(), static_cast<double>(k));
  }
}

TEST(Path, IsReadWhileItGoesOn) {
  Path path = path_of(0, 1, 100);
  const Path then = path;
  double sum = 0;
  std::thread reader([&] {
    for (int round = 0; round < 200; ++round) {
      for (std::size_t k = 0; k < then.size(); ++k) sum += then[k].T_odom_camera.t.x();
    }
  });
  for (int k = 100; k < 2000; ++k) path.append({k, 0.1 * k, at(k)});
  reader.join();
  EXPECT_EQ(sum, 200 * 4950.0);
  EXPECT_EQ(path.at(1999).t.x(), 1999);
}

}  // namespace
}  // namespace sgs::history
