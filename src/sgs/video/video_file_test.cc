// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/video/video_file.h"

#include <gmock/gmock.h>

#include <opencv2/videoio.hpp>

#include "sgs/io/temporary_folder.h"

namespace sgs::video {
namespace {

ColorImage plain(std::uint8_t value) {
  ColorImage image(65, 48);
  for (std::size_t i = 0; i < image.size(); ++i) image.data()[i] = {value, 0, 0};
  return image;
}

TEST(VideoFile, HoldsThePicturesInTheirOrder) {
  const io::TemporaryFolder folder;
  const auto path = folder.path() / "walk.avi";
  auto video = VideoFile::create(path, 65, 48, 25);
  ASSERT_TRUE(video) << video.error().text();
  for (const std::uint8_t value : {40, 120, 200}) video->add(plain(value));
  EXPECT_FALSE(std::filesystem::exists(path));
  ASSERT_TRUE(video->finish());
  cv::VideoCapture read(path.string());
  ASSERT_TRUE(read.isOpened());
  cv::Mat picture;
  for (const int value : {40, 120, 200}) {
    ASSERT_TRUE(read.read(picture));
    EXPECT_EQ(picture.cols, 64);
    EXPECT_NEAR(picture.at<cv::Vec3b>(20, 20)[2], value, 6);
  }
  EXPECT_FALSE(read.read(picture));
}

TEST(VideoFile, OneThatIsNotFinishedLeavesNothing) {
  const io::TemporaryFolder folder;
  {
    auto video = VideoFile::create(folder.path() / "walk.avi", 65, 48, 25);
    ASSERT_TRUE(video);
    video->add(plain(10));
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(VideoFile, AnEndingThatIsNotKnownIsRefused) {
  const auto video = VideoFile::create("walk.txt", 64, 48, 25);
  ASSERT_FALSE(video);
  EXPECT_THAT(video.error().remedy, testing::HasSubstr(".mp4"));
}

}  // namespace
}  // namespace sgs::video
