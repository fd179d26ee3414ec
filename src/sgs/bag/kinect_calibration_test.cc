// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Whole recordings are in tests/bags/kinect_test.py; here are the modes, by numbers worked out by
// hand.
#include "sgs/bag/kinect_calibration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace sgs::bag {
namespace {

using ::testing::HasSubstr;
using Json = nlohmann::json;

constexpr KinectSizes kSizes{1280, 720, 640, 576};

Json camera(const char* location, std::vector<double> unit, int width, int height) {
  // k1 to k6, the centre of distortion, p2, p1, and a radius that nothing is made of.
  for (const double v : {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.0, 0.0, 0.02, 0.01, 1.7}) {
    unit.push_back(v);
  }
  return {{"Location", std::string("CALIBRATION_CameraLocation") + location},
          {"Intrinsics",
           {{"ModelType", "CALIBRATION_LensDistortionModelBrownConrady"},
            {"ModelParameterCount", unit.size()},
            {"ModelParameters", unit}}},
          {"Rt", {{"Rotation", {1, 0, 0, 0, 1, 0, 0, 0, 1}}, {"Translation", {0, 0, 0}}}},
          {"SensorWidth", width},
          {"SensorHeight", height}};
}

Json sensor(const char* kind, std::vector<double> rotation) {
  return {{"SensorType", std::string("CALIBRATION_InertialSensorType_") + kind},
          {"Rt", {{"Rotation", rotation}, {"Translation", {0, 0, 0}}}}};
}

/// A depth camera at 0.5 of its sensor's sides and a colour camera at a little less.
Json calibration(int color_width = 4096, int color_height = 3072) {
  return {{"CalibrationInformation",
           {{"Cameras",
             {camera("D0", {0.5, 0.5, 0.25, 0.25}, 1024, 1024),
              camera("PV0", {0.5, 0.5, 0.5, 0.625}, color_width, color_height)}},
            {"InertialSensors", Json::array()}}}};
}

KinectCalibration read(const Json& json, const KinectSizes& sizes = kSizes) {
  auto read = read_kinect_calibration(json.dump(), "x", sizes);
  EXPECT_TRUE(read) << read.error().text();
  return read.value_or(KinectCalibration{});
}

TEST(KinectCalibration, EachDepthModeShowsItsPartOfTheSensor) {
  struct Case {
    int width, height;
    double f, cx, cy;
  };
  // Narrow: 512 - 192 - 0.5 across, 512 - 180 - 0.5 down; half of that where pixels are joined.
  for (const Case& c : {Case{640, 576, 256, 319.5, 331.5}, Case{320, 288, 128, 159.5, 165.5},
                        Case{1024, 1024, 256, 511.5, 511.5}, Case{512, 512, 128, 255.5, 255.5}}) {
    const auto read = bag::read(calibration(), {1280, 720, c.width, c.height});
    EXPECT_EQ(read.depth.camera, (PinholeCamera{c.width, c.height, c.f, c.f, c.cx, c.cy}));
  }
}

TEST(KinectCalibration, ColourOf16To9IsTheMiddleOfTheSensor) {
  const auto wide = read(calibration());
  EXPECT_EQ(wide.color.camera, (PinholeCamera{1280, 720, 640, 600, 639.5, 359.5}));
  const auto whole = read(calibration(), {2048, 1536, 640, 576});
  EXPECT_EQ(whole.color.camera, (PinholeCamera{2048, 1536, 1024, 960, 1023.5, 767.5}));
  const auto off_centre = [] {
    Json json = calibration();
    json["CalibrationInformation"]["Cameras"][1]["Intrinsics"]["ModelParameters"][1] = 0.4;
    return json;
  }();
  // 0.4 * 2880 - 360 - 0.5
  EXPECT_NEAR(read(off_centre, {3840, 2160, 640, 576}).color.camera.cy, 791.5, 1e-9);
}

TEST(KinectCalibration, EarlyCalibrationsAreOfThatMiddle) {
  const auto wide = read(calibration(1920, 1080));
  // 0.625 of 720 pixels.
  EXPECT_EQ(wide.color.camera, (PinholeCamera{1280, 720, 640, 450, 639.5, 359.5}));
  const auto whole = read(calibration(1920, 1080), {4096, 3072, 640, 576});
  EXPECT_EQ(whole.color.camera, (PinholeCamera{4096, 3072, 2048, 1440, 2047.5, 1535.5}));
}

TEST(KinectCalibration, LensesAreInOurOrder) {
  const std::vector<double> expected = {0.1, 0.2, 0.01, 0.02, 0.3, 0.4, 0.5, 0.6};
  EXPECT_EQ(read(calibration()).color.distortion.written(), expected);
  EXPECT_EQ(read(calibration()).depth.distortion.written(), expected);
}

TEST(KinectCalibration, TransformsAreFromACommonWorld) {
  Json json = calibration();
  Json& cameras = json["CalibrationInformation"]["Cameras"];
  // Depth is a quarter turn about z, colour 3 cm beside the world.
  cameras[0]["Rt"]["Rotation"] = {0, -1, 0, 1, 0, 0, 0, 0, 1};
  cameras[1]["Rt"]["Translation"] = {0.03, 0, 0};
  json["CalibrationInformation"]["InertialSensors"] = {
      sensor("Gyro", {1, 0, 0, 0, 1, 0, 0, 0, 1}),
      sensor("Accelerometer", {0, 0, -1, -1, 0, 0, 0, 1, 0})};
  const auto calibration = read(json);
  // World x is depth y.
  EXPECT_TRUE(
      (calibration.T_color_depth * Eigen::Vector3d(0, 1, 0)).isApprox(Eigen::Vector3d(1.03, 0, 0)));
  ASSERT_TRUE(calibration.inertial);
  // The accelerometer's z is the world's y, its x what lies behind.
  const auto& unit = *calibration.inertial;
  EXPECT_TRUE((unit.T_color_accelerometer.R * Eigen::Vector3d(1, 0, 0))
                  .isApprox(Eigen::Vector3d(0, 0, -1)));
  EXPECT_TRUE((unit.R_accelerometer_gyroscope * Eigen::Vector3d(0, 1, 0))
                  .isApprox(Eigen::Vector3d(0, 0, 1)));
}

TEST(KinectCalibration, WithoutAnInertialUnitTheRestIsRead) {
  Json json = calibration();
  json["CalibrationInformation"].erase("InertialSensors");
  EXPECT_FALSE(read(json).inertial);
  json["CalibrationInformation"]["InertialSensors"] = 7;
  EXPECT_FALSE(read(json).inertial);
}

TEST(KinectCalibration, WhatIsNoneSaysWhy) {
  const auto refused = [](const std::string& text, const KinectSizes& sizes = kSizes) {
    const auto read = read_kinect_calibration(text, "calibration.json", sizes);
    EXPECT_FALSE(read);
    return read ? std::string() : read.error().message;
  };
  EXPECT_THAT(refused("{"), HasSubstr("calibration.json"));
  EXPECT_THAT(refused("{}"), HasSubstr("calibration.json: "));
  Json json = calibration();
  json["CalibrationInformation"]["Cameras"][0]["Location"] = "elsewhere";
  EXPECT_THAT(refused(json.dump()), HasSubstr("no Location CALIBRATION_CameraLocationD0"));
  json = calibration();
  json["CalibrationInformation"]["Cameras"][1]["Intrinsics"]["ModelParameters"] = {1, 2, 3};
  EXPECT_THAT(refused(json.dump()), HasSubstr("3 numbers of a lens"));
  json = calibration();
  json["CalibrationInformation"]["Cameras"][1]["Intrinsics"]["ModelParameters"][2] = -1;
  EXPECT_THAT(refused(json.dump()), HasSubstr("fx -1"));
  json = calibration();
  json["CalibrationInformation"]["Cameras"][0]["Rt"]["Rotation"][0] = 3;
  EXPECT_THAT(refused(json.dump()), HasSubstr("rigid"));
  EXPECT_THAT(refused(calibration().dump(), {1280, 800, 640, 576}), HasSubstr("1280x800"));
  EXPECT_THAT(refused(calibration().dump(), {1280, 720, 640, 480}), HasSubstr("640x480"));
}

}  // namespace
}  // namespace sgs::bag
