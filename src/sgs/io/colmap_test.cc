// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/io/colmap.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sgs/io/atomic_file.h"
#include "sgs/io/temporary_folder.h"

namespace sgs::io {
namespace {

using testing::HasSubstr;

Result<std::vector<ColmapImage>> parse(const std::string& text) {
  const TemporaryFolder folder;
  EXPECT_TRUE(write_file(folder / "images.txt", text));
  return load_colmap_images(folder / "images.txt");
}

TEST(LoadColmapImages, ReadsBackWhatWasWritten) {
  const TemporaryFolder folder;
  Vector6d xi;
  xi << 0.3, -1.2, 2.0, 0.4, 5.0, -6.0;
  const std::vector<ColmapImage> images = {{"b/2.png", SE3::exp(xi)}, {"a.jpg", SE3{}}};
  ASSERT_TRUE(save_colmap_model(folder.path(), {64, 48, 50, 50, 31.5, 23.5}, images, {}));
  const auto read = load_colmap_images(folder / "images.txt");
  ASSERT_TRUE(read) << read.error().text();
  ASSERT_EQ(read->size(), 2u);
  EXPECT_EQ((*read)[0].name, "b/2.png");
  EXPECT_TRUE((*read)[0].T_world_camera.t.isApprox(images[0].T_world_camera.t, 1e-7));
  EXPECT_TRUE((*read)[0].T_world_camera.R.isApprox(images[0].T_world_camera.R, 1e-7));
  EXPECT_EQ((*read)[1].name, "a.jpg");
}

// As COLMAP writes it: comments, rows of points or an empty row, line ends of Windows.
TEST(LoadColmapImages, EverySecondRowHoldsPointsOrNothing) {
  const auto read = parse(
      "# Image list with two lines of data per image:\n"
      "7 1 0 0 0 1 2 3 1 my photo.jpg\r\n"
      "12.5 3.5 -1 100.0 200.0 17\r\n"
      "9 0 1 0 0 0 0 1 1 last.png\n"
      "\n"
      "\n");
  ASSERT_TRUE(read) << read.error().text();
  ASSERT_EQ(read->size(), 2u);
  EXPECT_EQ((*read)[0].name, "my photo.jpg");
  EXPECT_EQ((*read)[0].T_world_camera.t, Eigen::Vector3d(-1, -2, -3));
  EXPECT_EQ((*read)[0].points, std::vector<std::int64_t>{17});
  EXPECT_TRUE((*read)[1].points.empty());
  EXPECT_EQ((*read)[1].name, "last.png");
}

TEST(LoadColmapImages, WhatIsNoModelIsRefusedWithItsLine) {
  EXPECT_THAT(parse("").error().text(), HasSubstr("no pictures"));
  EXPECT_THAT(parse("1 1 0 0 0 0 0 0 1\n").error().text(),
              HasSubstr("images.txt:1: not a picture"));
  EXPECT_THAT(parse("1 1 0 0 0 0 0 0 1 a\n\n2 1 0 0 x 0 0 0 1 b\n").error().text(),
              HasSubstr("images.txt:3: not a picture"));
  EXPECT_THAT(parse("1 1 0 0 0 0 0 inf 1 a\n").error().text(), HasSubstr("not a picture"));
  EXPECT_THAT(parse("1 2 0 0 0 0 0 0 1 a\n").error().text(), HasSubstr("no rotation"));
  EXPECT_FALSE(load_colmap_images("/no/such/images.txt"));
}

}  // namespace
}  // namespace sgs::io
