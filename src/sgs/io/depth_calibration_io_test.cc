// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/io/depth_calibration_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sgs/io/atomic_file.h"
#include "sgs/io/temporary_folder.h"

namespace sgs::io {
namespace {

using testing::HasSubstr;

DepthCalibration example() {
  DepthCalibration c;
  c.camera = {640, 480, 535.5, 539.25, 320.125, 247.5};
  c.grid = {3, 2};
  c.offset_per_m = {0.001, -0.002, 0.0035, 0, 1e-5, -0.25};
  c.sigma_per_m = {0.001, 0.002, 0.003, 0.004, 0.005, 0.006};
  c.mean_sigma_per_m = 0.0005;
  c.shift_px = {-1.5, 0.25};
  c.shift_sigma_px = {0.125, 0.0625};
  c.delay_s = 0.00390625;
  c.delay_sigma_s = 0.000125;
  return c;
}

class DepthCalibrationFile : public testing::Test {
 protected:
  TemporaryFolder folder;
  std::filesystem::path path = folder.path() / "calibration.toml";

  /// The example as a file in which `from` became `to`.
  void write_changed(const std::string& from, const std::string& to) {
    ASSERT_TRUE(save_depth_calibration(path, example()));
    std::string text = *read_file(path);
    const auto at = text.find(from);
    ASSERT_NE(at, std::string::npos) << text;
    ASSERT_TRUE(write_file(path, text.replace(at, from.size(), to)));
  }
  std::string error() const {
    const auto loaded = load_depth_calibration(path);
    return loaded ? "" : loaded.error().text();
  }
};

TEST_F(DepthCalibrationFile, ComesBackAsItWas) {
  ASSERT_TRUE(save_depth_calibration(path, example()));
  const auto loaded = load_depth_calibration(path);
  ASSERT_TRUE(loaded) << loaded.error().text();
  EXPECT_EQ(*loaded, example());
}

TEST_F(DepthCalibrationFile, OneFromBeforeDelaysWereKeptHasNone) {
  ASSERT_TRUE(save_depth_calibration(path, example()));
  std::string text = *read_file(path);
  const auto from = text.find("delay_s"), to = text.find("# 1/m, row by row");
  ASSERT_TRUE(from < to);
  ASSERT_TRUE(write_file(path, text.erase(from, to - from)));
  const auto loaded = load_depth_calibration(path);
  ASSERT_TRUE(loaded) << loaded.error().text();
  EXPECT_EQ(loaded->delay_s, 0);
}

TEST_F(DepthCalibrationFile, ALaterFormatIsRefused) {
  write_changed("format = 1", "format = 2");
  EXPECT_THAT(error(), HasSubstr("later version"));
}

TEST_F(DepthCalibrationFile, AnotherTomlFileIsNoCalibration) {
  ASSERT_TRUE(write_file(path, "[mapper]\nwindow = 3\n"));
  EXPECT_THAT(error(), HasSubstr("no depth calibration"));
}

TEST_F(DepthCalibrationFile, TheGridMustBeFull) {
  write_changed("rows = 2", "rows = 3");
  EXPECT_THAT(error(), HasSubstr("3 x 3 nodes"));
}

TEST_F(DepthCalibrationFile, WhatNoDepthCameraHasIsRefused) {
  write_changed("-0.25", "-25");
  EXPECT_THAT(error(), HasSubstr("offset_per_m"));
  write_changed("-0.25", "nan");
  EXPECT_THAT(error(), HasSubstr("offset_per_m"));
  write_changed("-0.25", "\"a\"");
  EXPECT_THAT(error(), HasSubstr("offset_per_m"));
  write_changed("columns = 3", "columns = 300000000");
  EXPECT_THAT(error(), HasSubstr("columns"));
}

TEST_F(DepthCalibrationFile, AMissingFileIsNamed) {
  EXPECT_THAT(error(), HasSubstr("calibration.toml"));
}

}  // namespace
}  // namespace sgs::io
