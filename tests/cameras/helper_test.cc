// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// What programs for cameras share.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/calibration.h"
#include "common/camera_words.h"
#include "common/library_log.h"
#include "common/shared_library.h"
#include "freenect/tick_clock.h"

namespace sgs::cameras {
namespace {

using ::testing::HasSubstr;

const CameraWords kWords = {"own", "own camera", "size=8x6", "size=4x3", {}, "plug it in"};

TEST(Calibration, MotionsAreReadByRowsAndByColumns) {
  const float by_rows[] = {0, -1, 0, 1, 0, 0, 0, 0, 1};  // a quarter turn
  const float by_columns[] = {0, 1, 0, -1, 0, 0, 0, 0, 1};
  const float shift_mm[] = {10, -20, 30};
  const SE3 rows = transform_of(by_rows, shift_mm, Order::kRows, 1e-3);
  const SE3 columns = transform_of(by_columns, shift_mm, Order::kColumns, 1e-3);
  const Eigen::Vector3d moved = rows * Eigen::Vector3d(1, 0, 0);
  EXPECT_LT((moved - Eigen::Vector3d(0.01, 0.98, 0.03)).norm(), 1e-7);
  EXPECT_EQ(columns.R, rows.R);
}

TEST(Calibration, UnitsAreWholeWhereSinglePrecisionIsNot) {
  EXPECT_EQ(units_per_metre(static_cast<double>(0.001F)), 1000);
  EXPECT_EQ(units_per_metre(static_cast<double>(0.0001F)), 10000);
  EXPECT_NEAR(units_per_metre(0.0003), 3333.333, 1e-3);
}

TEST(Calibration, TheNearestModeWithTheRate) {
  const SensorMode modes[] = {{1920, 1080, 30}, {640, 480, 15}, {640, 576, 30}, {1280, 720, 30}};
  capture::CameraMode wanted;
  EXPECT_EQ(nearest_mode(modes, wanted, false), 2U);
  EXPECT_FALSE(nearest_mode(modes, wanted, true));
  wanted.fps = 15;
  EXPECT_EQ(nearest_mode(modes, wanted, true), 1U);
  wanted.fps = 60;
  EXPECT_FALSE(nearest_mode(modes, wanted, false));
}

TEST(Calibration, PixelsWithoutGapsAndInOurOrder) {
  EXPECT_EQ(packed_rows("ab__cd__", 2, 2, 4, 1), "abcd");
  EXPECT_EQ(packed_rows("ab", 2, 1, 1, 1), "") << "a row that is longer than the next one's start";
  EXPECT_EQ(packed_rows(nullptr, 2, 1, 2, 1), "");
  EXPECT_EQ(rgb_of_bgra("bgraBGRA"), "rgbRGB");
}

TEST(TickClock, GoesOnWhereTheCounterWraps) {
  freenect::TickClock clock;
  constexpr std::uint32_t kStep = 2000000;
  std::uint32_t ticks = 0U - 3 * kStep;  // wraps at the fourth
  const double first_s = clock.seconds(ticks);
  for (int i = 1; i < 6; ++i) {
    ticks += kStep;
    EXPECT_NEAR(clock.seconds(ticks) - first_s, i / 30.0, 1e-9);
    EXPECT_NEAR(clock.seconds(ticks - 1000) - first_s, i / 30.0 - 1000 / 60e6, 1e-9) << "late";
  }
}

TEST(CameraWords, ErrorsOfLibrariesInOurs) {
  const std::pair<const char*, const char*> said[] = {
      {"LIBUSB_ERROR_BUSY", "used by another program"},
      {"Could not open camera: LIBUSB_ERROR_ACCESS", "no permission"},
      {"Couldn't resolve requests", "no such mode"},
      {"No such device (it may have been disconnected)", "not there any more"},
      {"42", "the camera's library says: 42"}};
  for (const auto& [message, words] : said) {
    EXPECT_THAT(explained(message, kWords).message, HasSubstr(words));
    EXPECT_FALSE(explained(message, kWords).remedy.empty());
  }
  EXPECT_THAT(explained("no such mode", kWords).remedy, HasSubstr("camera:own,size=8x6"));
}

TEST(CameraWords, WhichOfTheCameras) {
  EXPECT_EQ(index_of_camera({"1", "2"}, "", kWords).value(), 0U);
  EXPECT_EQ(index_of_camera({"1", "2"}, "2", kWords).value(), 1U);
  EXPECT_THAT(index_of_camera({"1", "2"}, "3", kWords).error().remedy, HasSubstr("1, 2"));
  EXPECT_THAT(index_of_camera({}, "3", kWords).error().message, HasSubstr("no own camera"));
}

TEST(CameraWords, Usb2IsSlow) {
  std::vector<std::string> notes;
  capture::CameraMode mode;
  EXPECT_TRUE(check_usb("3.2", mode, kWords, notes));
  EXPECT_THAT(check_usb("2.1", mode, kWords, notes).error().remedy, HasSubstr("size=4x3"));
  mode.given = true;
  EXPECT_TRUE(check_usb("2.1", mode, kWords, notes));
  EXPECT_EQ(notes.size(), 1U);
}

TEST(LibraryLog, IsTakenOnce) {
  LibraryLog log;
  log.add("one\n");
  log.add("two");
  EXPECT_EQ(log.take(), "one; two");
  EXPECT_EQ(log.take(), "");
  for (int i = 0; i < 1000; ++i) log.add(std::string(100, 'x'));
  EXPECT_LT(log.take().size(), 3000U);
}

TEST(SharedLibrary, FilesThatAreNone) {
  EXPECT_EQ(open_library_file("/nonexistent/libnone.so"), nullptr);
  EXPECT_EQ(real_path("/nonexistent/libnone.so"), "/nonexistent/libnone.so");
  const LibrarySearch search = {"libnone", "libnone.so.*", "SGS_NONE_LIBRARY", "build it"};
  EXPECT_EQ(library_candidates(search).front(), "libnone.so");
  const auto never = [](void*, const std::string&) -> Result<int> { return 1; };
  const auto opened = open_library(search, never);
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().message, "libnone is not installed");
}

}  // namespace
}  // namespace sgs::cameras
