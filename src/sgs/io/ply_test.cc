// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/io/ply.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <string>

#include "sgs/io/atomic_file.h"
#include "sgs/io/temporary_folder.h"

namespace sgs::io {
namespace {

using testing::HasSubstr;

std::vector<map::Gaussian> test_splats() {
  return {{{1, 2, 3}, {-4, -5, -6}, {1, 2, -2, 4}, 0.5f, {0.1f, 0.5f, 1.2f}, {0, 0}},
          {{-1, 0, 9}, {-1, -2, -3}, {1, 0, 0, 0}, -3, {0, 1, 0.25f}, {0, 0}}};
}

TEST(Ply, SplatsRoundTripWithUnitQuaternions) {
  const TemporaryFolder folder;
  const auto splats = test_splats();
  ASSERT_TRUE(save_splats(folder / "m.ply", splats));
  const auto back = load_splats(folder / "m.ply");
  ASSERT_TRUE(back) << back.error().text();
  ASSERT_EQ(back->gaussians.size(), 2u);
  EXPECT_TRUE(back->harmonics.empty());
  for (std::size_t i = 0; i < 2; ++i) {
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(back->gaussians[i].mean[k], splats[i].mean[k]);
      EXPECT_EQ(back->gaussians[i].log_scale[k], splats[i].log_scale[k]);
      EXPECT_NEAR(back->gaussians[i].rgb[k], splats[i].rgb[k], 1e-6);
    }
    EXPECT_EQ(back->gaussians[i].opacity_logit, splats[i].opacity_logit);
  }
  for (int k = 0; k < 4; ++k) {
    EXPECT_NEAR(back->gaussians[0].rotation[k], splats[0].rotation[k] / 5, 1e-7);
  }
}

TEST(Ply, HeaderIsTheStandardLayout) {
  const TemporaryFolder folder;
  ASSERT_TRUE(save_splats(folder / "m.ply", test_splats()));
  const std::string bytes = read_file(folder / "m.ply").value();
  const auto body = bytes.find("end_header\n") + 11;
  EXPECT_EQ(bytes.size() - body, 2u * 17 * 4);
  EXPECT_THAT(bytes, HasSubstr("ply\nformat binary_little_endian 1.0\nelement vertex 2\n"
                               "property float x\nproperty float y\nproperty float z\n"
                               "property float nx\n"));
}

const char* const kShuffledHeader =
    "ply\nformat ascii 1.0\ncomment any order, more properties, no normals\nelement vertex 1\n"
    "property double rot_0\nproperty float rot_1\nproperty float rot_2\nproperty float rot_3\n"
    "property float f_rest_0\nproperty uchar label\nproperty float scale_2\n"
    "property float scale_1\nproperty float scale_0\nproperty float opacity\n"
    "property float f_dc_2\nproperty float f_dc_1\nproperty float f_dc_0\n"
    "property float z\nproperty float y\nproperty float x\nend_header\n";

TEST(Ply, ReadsAnyOrderInAscii) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_file(folder / "a.ply", std::string(kShuffledHeader) +
                                               "1 0 0 0 9.5 7 -3 -2 -1 0.25 0 0 1 30 20 10\n"));
  const auto splats = load_splats(folder / "a.ply");
  ASSERT_TRUE(splats) << splats.error().text();
  const map::Gaussian& g = splats->gaussians.at(0);
  EXPECT_EQ(g.mean[0], 10);
  EXPECT_EQ(g.mean[2], 30);
  EXPECT_EQ(g.log_scale[0], -1);
  EXPECT_EQ(g.rotation[0], 1);
  EXPECT_EQ(g.opacity_logit, 0.25f);
  EXPECT_NEAR(g.rgb[0], 0.5 + 0.28209479177387814, 1e-6);
  EXPECT_EQ(g.rgb[1], 0.5f);
}

TEST(Ply, BadFilesAreErrorsThatNameThem) {
  const TemporaryFolder folder;
  const auto path = folder / "bad.ply";
  const auto error_of = [&](const std::string& bytes) {
    EXPECT_TRUE(write_file(path, bytes));
    const auto splats = load_splats(path);
    EXPECT_FALSE(splats);
    return splats ? std::string() : splats.error().message;
  };
  ASSERT_TRUE(save_splats(path, test_splats()));
  const std::string good = read_file(path).value();
  for (const std::size_t cut : {1u, 67u, 68u, 137u, 200u}) {
    EXPECT_THAT(error_of(good.substr(0, good.size() - cut)), HasSubstr("truncated")) << cut;
  }
  EXPECT_THAT(error_of(""), HasSubstr("bad.ply"));
  EXPECT_THAT(error_of("not a ply"), HasSubstr("not a PLY"));
  std::string other = good;
  other.replace(other.find("opacity"), 7, "opacitx");
  EXPECT_THAT(error_of(other), HasSubstr("'opacity' is missing"));
  other = good;
  other.replace(other.find("vertex 2"), 8, "vertex 99999999999999999");
  EXPECT_THAT(error_of(other), HasSubstr("truncated"));
  other = good;
  other.replace(other.find("little"), 6, "big");
  EXPECT_THAT(error_of(other), HasSubstr("not supported"));
  EXPECT_THAT(error_of(std::string(kShuffledHeader) + "1 0 0 0 9 7 -3 -2 -1 nan 0 0 1 30 20 10\n"),
              HasSubstr("vertex 0: opacity is nan"));
  EXPECT_THAT(error_of(std::string(kShuffledHeader) + "0 0 0 0 9 7 -3 -2 -1 1 0 0 1 30 20 10\n"),
              HasSubstr("rotation is zero"));
  EXPECT_THAT(error_of(std::string(kShuffledHeader) + "1 0 0\n"), HasSubstr("16 numbers"));
}

TEST(Ply, InfiniteOpacityIsClampedAndFinite) {
  const TemporaryFolder folder;
  const auto path = folder / "opaque.ply";
  const std::vector<map::Gaussian> splats = test_splats();
  ASSERT_TRUE(save_splats(path, splats));
  std::string bytes = read_file(path).value();
  const std::size_t body = bytes.find("end_header\n") + 11;
  const float infinite = std::numeric_limits<float>::infinity();
  std::memcpy(bytes.data() + body + 9 * sizeof(float), &infinite, sizeof infinite);
  ASSERT_TRUE(write_file(path, bytes));
  const auto back = load_splats(path);
  ASSERT_TRUE(back) << back.error().text();
  EXPECT_EQ(back->gaussians[0].opacity_logit, 16);
  EXPECT_EQ(back->gaussians[1].opacity_logit, splats[1].opacity_logit);
}

TEST(Ply, NotFiniteIsNotWritten) {
  const TemporaryFolder folder;
  auto splats = test_splats();
  splats[1].rgb[2] = std::numeric_limits<float>::quiet_NaN();
  const auto status = save_splats(folder / "m.ply", splats);
  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().message, HasSubstr("Gaussian 1"));
  EXPECT_FALSE(std::filesystem::exists(folder / "m.ply"));
}

TEST(Ply, PointsAndEmptyMaps) {
  const TemporaryFolder folder;
  const std::vector<ColoredPoint> points = {{{1, 2, 3}, {4, 5, 6}}};
  ASSERT_TRUE(save_points(folder / "p.ply", points));
  const std::string bytes = read_file(folder / "p.ply").value();
  EXPECT_EQ(bytes.size() - (bytes.find("end_header\n") + 11), 15u);
  EXPECT_EQ(bytes.substr(bytes.size() - 3), "\x04\x05\x06");
  ASSERT_TRUE(save_splats(folder / "e.ply", {}));
  EXPECT_TRUE(load_splats(folder / "e.ply").value().gaussians.empty());
}

map::Harmonics test_harmonics(int degree) {
  map::Harmonics harmonics{degree, {}};
  harmonics.resize(2);
  for (std::size_t i = 0; i < harmonics.coefficients.size(); ++i) {
    harmonics.coefficients[i] = 0.01f * static_cast<float>(i) - 0.2f;
  }
  return harmonics;
}

TEST(Ply, HarmonicsRoundTrip) {
  const TemporaryFolder folder;
  for (int degree = 1; degree <= map::kMaxHarmonicDegree; ++degree) {
    const map::Harmonics harmonics = test_harmonics(degree);
    ASSERT_TRUE(save_splats(folder / "h.ply", test_splats(), harmonics));
    const auto back = load_splats(folder / "h.ply");
    ASSERT_TRUE(back) << back.error().text();
    EXPECT_EQ(back->harmonics.degree, degree);
    EXPECT_EQ(back->harmonics.coefficients, harmonics.coefficients);
    EXPECT_EQ(back->gaussians[1].opacity_logit, test_splats()[1].opacity_logit);
  }
}

// One channel after the other, as 3D Gaussian Splatting writes them.
TEST(Ply, HarmonicsAreStoredChannelByChannel) {
  const TemporaryFolder folder;
  const map::Harmonics harmonics = test_harmonics(1);
  ASSERT_TRUE(save_splats(folder / "h.ply", test_splats(), harmonics));
  const std::string bytes = read_file(folder / "h.ply").value();
  float rest[9];
  std::memcpy(rest, bytes.data() + bytes.find("end_header\n") + 11 + 9 * sizeof(float),
              sizeof rest);
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(rest[3 * c + k], harmonics.of(0)[3 * k + c]);
  }
}

TEST(Ply, HarmonicsThatAreNotFiniteAreRefusedBothWays) {
  const TemporaryFolder folder;
  map::Harmonics harmonics = test_harmonics(2);
  ASSERT_TRUE(save_splats(folder / "h.ply", test_splats(), harmonics));
  std::string bytes = read_file(folder / "h.ply").value();
  const float bad = std::numeric_limits<float>::quiet_NaN();
  std::memcpy(bytes.data() + bytes.find("end_header\n") + 11 + 10 * sizeof bad, &bad, sizeof bad);
  ASSERT_TRUE(write_file(folder / "bad.ply", bytes));
  const auto read = load_splats(folder / "bad.ply");
  ASSERT_FALSE(read);
  EXPECT_THAT(read.error().message, HasSubstr("vertex 0: f_rest"));
  harmonics.coefficients[30] = bad;
  EXPECT_FALSE(save_splats(folder / "none.ply", test_splats(), harmonics));
}

}  // namespace
}  // namespace sgs::io
