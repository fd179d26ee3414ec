// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/sdk_calibration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sgs/dataset/bags/test_bag.h"

namespace sgs::dataset {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::string kDepth = "/device_0/sensor_0/Depth_0", kColor = "/device_0/sensor_1/Color_0";

TEST(SdkCalibration, TextOfRealSenseIsRead) {
  MemoryBag bag;
  const auto info = bag.topic(kColor + "/camera_info", "std_msgs/String");
  bag.add(info, packed_text("width=640;height=480;fx=610.5;ppx=320.25;fy=611;ppy=240;model=Inverse "
                            "Brown Conrady;coeffs=0.1,0.2,0,0,0.3"));
  const auto channel = sdk_info_channel(bag, kColor + "/image/data");
  ASSERT_EQ(channel, info);
  const auto message = bag.read({info})->next();
  const auto read = read_any_camera_info(**message, bag.channels()[info]);
  ASSERT_TRUE(read) << read.error().text();
  EXPECT_EQ(read->width, 640u);
  EXPECT_EQ(read->K[0], 610.5);
  EXPECT_EQ(read->K[2], 320.25);
  EXPECT_EQ(read->K[4], 611);
  EXPECT_THAT(read->D, ElementsAre(0.1, 0.2, 0, 0, 0.3));
  EXPECT_THAT(read->distortion_model, HasSubstr("Inverse"));
}

TEST(SdkCalibration, TransformsAsTextAreByColumnsAndIntoTheStream) {
  MemoryBag bag;
  // A quarter turn about z: its columns are (0 1 0), (-1 0 0), (0 0 1).
  bag.add(bag.topic(kColor + "/tf/ref_0", "std_msgs/String"),
          packed_text("rotation=0,1,0,-1,0,0,0,0,1;translation=0.1,0.2,0.3"));
  bag.add(bag.topic(kDepth + "/tf/ref_0", "std_msgs/String"),
          packed_text("rotation=1,0,0,0,1,0,0,0,1;translation=0,0,0"));
  const auto found = sdk_extrinsics(bag, kColor + "/image/data", kDepth + "/image/data");
  ASSERT_TRUE(found && *found);
  const Eigen::Vector3d moved = (*found)->T_color_depth * Eigen::Vector3d(1, 0, 0);
  EXPECT_TRUE(moved.isApprox(Eigen::Vector3d(0.1, 1.2, 0.3))) << moved;
}

TEST(SdkCalibration, UnitsAreTakenFromTheSensorOfDepth) {
  for (const auto& [type, data, units] :
       {std::tuple("std_msgs/String", packed_text("0.000250"), 4000.0),
        std::tuple("std_msgs/Float32", packed(0.0001f), 10000.0)}) {
    MemoryBag bag;
    bag.add(bag.topic("/device_0/sensor_0/option/Depth_Units/value", type), data);
    const auto unit = sdk_depth_unit(bag, kDepth + "/image/data");
    ASSERT_TRUE(unit && *unit) << type;
    EXPECT_EQ((*unit)->units_per_metre, units);
  }
  MemoryBag bag;
  bag.add(bag.topic("/device_0/sensor_0/option/Depth_Units/value", "std_msgs/String"),
          packed_text("none"));
  EXPECT_FALSE(sdk_depth_unit(bag, kDepth + "/image/data"));
  EXPECT_FALSE(*sdk_depth_unit(MemoryBag(), kDepth + "/image/data"));
}

/// custom_msg/OBProperty.
std::string orbbec_setting(std::uint32_t number, const std::string& data) {
  return packed_header(0, "") + packed(number) + packed_text(data) +
         packed(static_cast<std::uint32_t>(data.size()));
}

TEST(SdkCalibration, OrbbecsUnitIsASetting) {
  constexpr std::uint32_t kUnit = 176, kLevel = 75, kOther = 14;
  const auto unit = [](const std::vector<std::string>& settings) {
    MemoryBag bag;
    const auto channel = bag.topic("/cam/property", "custom_msg/OBProperty");
    for (const std::string& setting : settings) bag.add(channel, setting);
    return sdk_depth_unit(bag, "/cam/sensor_3/frameType_3");
  };
  const std::string other = orbbec_setting(kOther, packed<std::int32_t>(1));
  const auto level = [&](std::int32_t value) { return orbbec_setting(kLevel, packed(value)); };
  EXPECT_FALSE(*unit({other}));
  EXPECT_FALSE(*unit({level(7)}));
  EXPECT_FALSE(*unit({level(-1)}));
  EXPECT_FALSE(*unit({orbbec_setting(kLevel, "x"), "damaged"}));
  EXPECT_EQ((*unit({other, level(0)}))->units_per_metre, 1000);
  EXPECT_EQ((*unit({other, level(1)}))->units_per_metre, 1250);
  EXPECT_EQ((*unit({level(6)}))->units_per_metre, 20000);
  // The number counts where both are there, and is meant as it was written.
  EXPECT_EQ((*unit({level(0), orbbec_setting(kUnit, packed(0.1f))}))->units_per_metre, 10000);
  EXPECT_FALSE(unit({orbbec_setting(kUnit, packed(0.0f))}));
}

TEST(SdkCalibration, OrbbecsAccelerometerTurnsIntoColour) {
  MemoryBag bag;
  const std::string topic = "/cam/sensor_4/frameType_4";
  EXPECT_FALSE(sdk_imu_rotation(bag, topic));
  const auto numbers = [](std::initializer_list<float> values) {
    std::string bytes;
    for (const float value : values) bytes += packed(value);
    return bytes;
  };
  std::string unit = packed_header(0, "");
  for (int i = 0; i < 6; ++i) unit += packed<std::uint8_t>(1);
  // Quarter turns: about z from the unit to depth, about x from depth to colour.
  unit += numbers({0, -1, 0, 1, 0, 0, 0, 0, 1, 10, 0, 0});
  bag.add(bag.topic("/cam/streamProfileType_4", "custom_msg/OBImuStreamProfileInfo"), unit);
  EXPECT_FALSE(sdk_imu_rotation(bag, topic));
  std::string depth = packed_header(0, "") + packed<std::uint8_t>(3) + packed<std::uint8_t>(28) +
                      numbers({1, 0, 0, 0, 0, -1, 0, 1, 0, 0, 0, 0});
  for (const std::uint16_t v : {640, 400, 30}) depth += packed(v);
  depth += numbers({475, 476, 320, 200, 0, 0, 0, 0, 0, 0, 0, 0});
  bag.add(bag.topic("/cam/streamProfileType_3", "custom_msg/OBStreamProfileInfo"), depth);
  const auto R = sdk_imu_rotation(bag, topic);
  ASSERT_TRUE(R);
  // The unit's x is depth's y, which is colour's z.
  EXPECT_TRUE((*R * Eigen::Vector3d(1, 0, 0)).isApprox(Eigen::Vector3d(0, 0, 1)));
  EXPECT_FALSE(sdk_imu_rotation(bag, "/imu"));
}

TEST(SdkCalibration, OrbbecHasAMessageOfItsOwn) {
  MemoryBag bag;
  std::string profile = packed_header(0, "") + packed<std::uint8_t>(3) + packed<std::uint8_t>(28);
  // By rows: a quarter turn about z, and millimetres.
  for (const float v : {0.f, -1.f, 0.f, 1.f, 0.f, 0.f, 0.f, 0.f, 1.f, 100.f, 200.f, 300.f}) {
    profile += packed(v);
  }
  for (const std::uint16_t v : {640, 400, 30}) profile += packed(v);
  for (const float v : {475.f, 476.f, 320.f, 200.f}) profile += packed(v);
  for (const float v : {1.f, 2.f, 3.f, 4.f, 5.f, 6.f, 7.f, 8.f}) profile += packed(v);
  profile += packed<std::uint8_t>(1);
  const auto channel = bag.topic("/cam/streamProfileType_3", "custom_msg/OBStreamProfileInfo");
  bag.add(channel, profile);
  const std::string depth = "/cam/sensor_3/frameType_3", color = "/cam/sensor_2/frameType_2";
  EXPECT_TRUE(is_sdk_topic(depth));
  ASSERT_EQ(sdk_info_channel(bag, depth), channel);
  const auto message = bag.read({channel})->next();
  const auto info = read_any_camera_info(**message, bag.channels()[channel]);
  ASSERT_TRUE(info) << info.error().text();
  EXPECT_EQ(info->height, 400u);
  EXPECT_EQ(info->K[4], 476);
  EXPECT_EQ(info->K[5], 200);
  EXPECT_THAT(info->D, ElementsAre(1, 2, 7, 8, 3, 4, 5, 6));
  const auto found = sdk_extrinsics(bag, color, depth);
  ASSERT_TRUE(found && *found);
  const Eigen::Vector3d moved = (*found)->T_color_depth * Eigen::Vector3d(1, 0, 0);
  EXPECT_TRUE(moved.isApprox(Eigen::Vector3d(0.1, 1.2, 0.3))) << moved;
}

}  // namespace
}  // namespace sgs::dataset
