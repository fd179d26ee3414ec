// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/imu.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sgs/io/atomic_file.h"
#include "sgs/io/temporary_folder.h"

namespace sgs::dataset {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(AccelerometerText, IsReadInOrderOfTime) {
  const ImuRecording imu = read_accelerometer_text(
      "# timestamp ax ay az\n12.5 0.5 7.4 -6.3\n12.25\t1 2 3 # turned\n\n13, 4, 5, 6\n", "a.txt");
  EXPECT_EQ(imu.source, "a.txt");
  EXPECT_THAT(imu.warnings, IsEmpty());
  ASSERT_EQ(imu.samples.size(), 3u);
  EXPECT_EQ(imu.samples[0].timestamp_s, 12.25);
  EXPECT_EQ(imu.samples[1].acceleration, Eigen::Vector3d(0.5, 7.4, -6.3));
  EXPECT_EQ(imu.samples[2].acceleration, Eigen::Vector3d(4, 5, 6));
  EXPECT_FALSE(imu.samples[0].angular_velocity_rad_s);
  // A camera held level feels up along its -y axis, which the Kinect's accelerometer calls y.
  ASSERT_TRUE(imu.R_camera_imu);
  EXPECT_EQ(*imu.R_camera_imu * Eigen::Vector3d::UnitY(), -Eigen::Vector3d::UnitY());
  EXPECT_EQ(imu.R_camera_imu->determinant(), 1);
}

TEST(AccelerometerText, LinesThatCannotBeReadAreNamedAndLeftOut) {
  const ImuRecording imu =
      read_accelerometer_text("1 0 9.8 0\n2 0 9.8\nx 0 9.8 0\n4 0 nan 0\n5 0 9.8 0\n", "a.txt");
  EXPECT_EQ(imu.samples.size(), 2u);
  EXPECT_THAT(imu.warnings,
              ElementsAre("a.txt:2: not 'timestamp ax ay az'; 3 such lines are left out"));
}

TEST(AccelerometerText, WithoutAnyLineSaysWhatIsDoneInstead) {
  for (const char* text : {"", "# nothing\n", "\x01\x02 junk\n"}) {
    const ImuRecording imu = read_accelerometer_text(text, "a.txt");
    EXPECT_THAT(imu.samples, IsEmpty());
    ASSERT_FALSE(imu.warnings.empty());
    EXPECT_THAT(imu.warnings.back(), HasSubstr("a.txt: no line says 'timestamp ax ay az'"));
  }
}

TEST(ReadImu, TakesTheFileBesideTheFrames) {
  const io::TemporaryFolder folder;
  SequenceInfo info;
  EXPECT_TRUE(read_imu(info).source.empty());  // of the generator
  info.folder = folder.path();
  EXPECT_TRUE(read_imu(info).source.empty());
  ASSERT_TRUE(io::write_file(folder.path() / "accelerometer.txt", "1 0 9.8 0\n"));
  EXPECT_EQ(accelerometer_file(folder.path()), folder.path() / "accelerometer.txt");
  const ImuRecording imu = read_imu(info);
  EXPECT_EQ(imu.source, (folder.path() / "accelerometer.txt").string());
  EXPECT_EQ(imu.samples.size(), 1u);
}

TEST(ReadImu, ABagThatIsGoneIsAWarning) {
  SequenceInfo info;
  info.folder = "gone.bag";
  info.color_topic = "/color";
  info.depth_topic = "/depth";
  const ImuRecording imu = read_imu(info);
  EXPECT_THAT(imu.samples, IsEmpty());
  EXPECT_THAT(imu.warnings, ElementsAre(HasSubstr("gone.bag")));
}

}  // namespace
}  // namespace sgs::dataset
