// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/dataset/bags/bag_lens.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sgs::dataset {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

bag::CameraInfoMessage info_of(int width, int height, double f) {
  bag::CameraInfoMessage info;
  info.width = static_cast<std::uint32_t>(width);
  info.height = static_cast<std::uint32_t>(height);
  info.distortion_model = "plumb_bob";
  info.K = {f, 0, width / 2.0, 0, f, height / 2.0, 0, 0, 1};
  info.P = {f + 5, 0, width / 2.0, 0, 0, f + 5, height / 2.0, 0, 0, 0, 1, 0};
  return info;
}

TEST(BagLens, KOfPicturesAsTheyComePOfRectifiedOnesAndWhereThereIsNoK) {
  auto info = info_of(640, 480, 500);
  std::vector<std::string> warnings;
  EXPECT_EQ(lens_of(info, "/info", false, {640, 480}, warnings)->camera.fx, 500);
  EXPECT_EQ(lens_of(info, "/info", true, {640, 480}, warnings)->camera.fx, 505);
  EXPECT_THAT(warnings, IsEmpty());
  info.K = {};
  EXPECT_EQ(lens_of(info, "/info", false, {640, 480}, warnings)->camera.fx, 505);
  EXPECT_THAT(warnings.at(0), HasSubstr("P is taken"));
  info.P = {};
  const auto none = lens_of(info, "/info", false, {640, 480}, warnings);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, ErrorCode::kNotFound);
  EXPECT_THAT(none.error().text(), HasSubstr("--camera"));
}

TEST(BagLens, BinningAndTheRegionOfInterestAreAllowedFor) {
  auto info = info_of(1280, 960, 1000);
  info.roi_x = 320, info.roi_y = 240, info.roi_width = 640, info.roi_height = 480;
  info.binning_x = info.binning_y = 2;
  std::vector<std::string> warnings;
  const auto lens = lens_of(info, "/info", false, {320, 240}, warnings);
  ASSERT_TRUE(lens) << lens.error().text();
  EXPECT_EQ(lens->camera.width, 320);
  EXPECT_EQ(lens->camera.fx, 500);
  // The middle of a pixel of 2x2 lies between theirs.
  EXPECT_DOUBLE_EQ(lens->camera.cx, (640 - 320 + 0.5) / 2 - 0.5);
  EXPECT_DOUBLE_EQ(lens->camera.cy, (480 - 240 + 0.5) / 2 - 0.5);
  EXPECT_THAT(warnings.at(0), HasSubstr("allowed for"));
  // Drivers that bin and say so, but give the numbers of the pictures that they send.
  warnings.clear();
  EXPECT_EQ(lens_of(info, "/info", false, {1280, 960}, warnings)->camera.fx, 1000);
  EXPECT_THAT(warnings.at(0), HasSubstr("left out of account"));
}

TEST(BagLens, AnotherSizeOfOneShapeIsScaledAnotherShapeIsRefused) {
  const auto info = info_of(640, 480, 500);
  std::vector<std::string> warnings;
  const auto half = lens_of(info, "/info", false, {320, 240}, warnings);
  ASSERT_TRUE(half);
  EXPECT_EQ(half->camera.fx, 250);
  EXPECT_THAT(warnings.at(0), HasSubstr("scaled"));
  const auto wide = lens_of(info, "/info", false, {640, 360}, warnings);
  ASSERT_FALSE(wide);
  EXPECT_EQ(wide.error().code, ErrorCode::kUnsupported);
  EXPECT_THAT(wide.error().text(), HasSubstr("640x360"));
}

TEST(BagLens, FisheyeIsAWarningWithoutCoefficientsAndALensWithThem) {
  auto info = info_of(640, 480, 430);
  info.distortion_model = "equidistant";
  for (const auto& none : {std::vector<double>{}, std::vector<double>(4, 0.0)}) {
    info.D = none;
    std::vector<std::string> warnings;
    ASSERT_TRUE(lens_of(info, "/info", false, {640, 480}, warnings));
    EXPECT_THAT(warnings.at(0), HasSubstr("fisheye"));
  }
  std::vector<std::string> warnings;
  for (const char* name : {"equidistant", "fisheye", "kannala_brandt", "Kannala Brandt4"}) {
    info.distortion_model = name;
    info.D = {0.1, 0.01, 0, 0, 0};  // RealSense's drivers write five for each model
    const auto lens = lens_of(info, "/info", false, {640, 480}, warnings);
    ASSERT_TRUE(lens) << lens.error().text();
    EXPECT_TRUE(lens->distortion.is_fisheye());
    EXPECT_EQ(lens->distortion.written(), (std::vector<double>{0.1, 0.01, 0, 0}));
  }
  EXPECT_TRUE(warnings.empty());
  for (const auto& [name, D] : {std::pair("equidistant", std::vector<double>{0.1, 0, 0, 0, 0.1}),
                                std::pair("ftheta", std::vector<double>{0.9, 0, 0, 0, 0})}) {
    info.distortion_model = name;
    info.D = D;
    const auto lens = lens_of(info, "/info", false, {640, 480}, warnings);
    ASSERT_FALSE(lens);
    EXPECT_THAT(lens.error().text(), HasSubstr(name));
    EXPECT_THAT(lens.error().text(), HasSubstr("--camera fx,fy,cx,cy"));
  }
}

TEST(BagLens, CoefficientsBeyondEightMayBeThereAsZeros) {
  auto info = info_of(640, 480, 430);
  info.distortion_model = "rational_polynomial";
  info.D = {0.1, 0.02, 0, 0, 0.03, 0.1, 0.01, 0, 0, 0, 0, 0, 0, 0};
  std::vector<std::string> warnings;
  const auto lens = lens_of(info, "/info", false, {640, 480}, warnings);
  ASSERT_TRUE(lens) << lens.error().text();
  EXPECT_EQ(lens->distortion.k5, 0.01);
  info.D.back() = 0.1;
  EXPECT_FALSE(lens_of(info, "/info", false, {640, 480}, warnings));
}

TEST(BagLens, ViewsAreComparedWithoutTheirLenses) {
  const PinholeCamera a{640, 480, 528, 528, 320, 240};
  EXPECT_TRUE(same_view(a, {640, 480, 530, 530, 318, 242}));
  EXPECT_FALSE(same_view(a, {640, 480, 700, 700, 320, 240}));
  EXPECT_FALSE(same_view(a, {640, 480, 528, 528, 350, 240}));
  EXPECT_TRUE(same_lens({a, {}}, {{640, 480, 528.0001, 528, 320, 240}, {}}));
  EXPECT_FALSE(same_lens({a, {}}, {a, {0.1, 0, 0, 0, 0}}));
}

}  // namespace
}  // namespace sgs::dataset
