// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <random>
#include <tuple>

#include "sgs/io/atomic_file.h"
#include "sgs/io/colmap.h"
#include "sgs/io/gzip.h"
#include "sgs/io/splat_check.h"
#include "sgs/io/splat_file.h"
#include "sgs/io/spz.h"
#include "sgs/io/temporary_folder.h"
#include "sgs/io/text.h"
#include "sgs/io/zstd.h"

namespace sgs::io {
namespace {

using ::testing::HasSubstr;

std::vector<map::Gaussian> random_splats(int count) {
  std::mt19937_64 engine(5);
  const auto uniform = [&](double low, double high) {
    return static_cast<float>(low + (high - low) * static_cast<double>(engine() >> 11) * 0x1p-53);
  };
  std::vector<map::Gaussian> splats;
  for (int i = 0; i < count; ++i) {
    map::Gaussian g{};
    for (int k = 0; k < 3; ++k) {
      g.mean[k] = uniform(-20, 20);
      g.log_scale[k] = uniform(-9, 1);
      g.rgb[k] = uniform(0, 1);
    }
    for (float& q : g.rotation) q = uniform(-2, 2);
    g.opacity_logit = uniform(-4, 4);
    splats.push_back(g);
  }
  return splats;
}

/// Angle between two rotations, radians, up to half turns about the axes of the ellipsoid.
double angle(const map::Gaussian& a, const map::Gaussian& b) {
  const auto p = unit_rotation(a), q = unit_rotation(b);
  const Eigen::Quaterniond difference = Eigen::Quaterniond(p[0], p[1], p[2], p[3]).conjugate() *
                                        Eigen::Quaterniond(q[0], q[1], q[2], q[3]);
  return 2 * std::acos(std::min(1.0, difference.coeffs().cwiseAbs().maxCoeff()));
}

struct Tolerance {
  double mean, log_scale, rgb, opacity, angle;
};
void expect_near(const std::vector<map::Gaussian>& a, const std::vector<map::Gaussian>& b,
                 const Tolerance& tolerance) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(a[i].mean[k], b[i].mean[k], tolerance.mean);
      EXPECT_NEAR(a[i].log_scale[k], b[i].log_scale[k], tolerance.log_scale);
      EXPECT_NEAR(a[i].rgb[k], b[i].rgb[k], tolerance.rgb);
    }
    EXPECT_NEAR(map::opacity<double>(a[i]), map::opacity<double>(b[i]), tolerance.opacity);
    EXPECT_LT(angle(a[i], b[i]), tolerance.angle);
  }
}

TEST(SplatFile, RoundTrip) {
  const auto splats = random_splats(500);
  const std::string records = splat_records(splats);
  EXPECT_EQ(records.size(), 500 * kSplatRecordBytes);
  expect_near(splats_from_records(records), splats,
              {0, 1e-6, 0.5 / 255 + 1e-6, 0.5 / 255 + 1e-6, 0.025});
}

TEST(SplatFile, ByteLayout) {
  map::Gaussian g{};
  g.mean[1] = 2;
  g.rotation[0] = 3;  // need not be unit
  g.rgb[0] = 1;
  g.rgb[2] = 7;  // beyond the range
  const std::string r = splat_records({&g, 1});
  const auto byte = [&](std::size_t i) {
    return static_cast<int>(static_cast<unsigned char>(r[i]));
  };
  EXPECT_EQ(r.substr(4, 4), std::string("\0\0\0@", 4));     // 2.0f
  EXPECT_EQ(r.substr(12, 4), std::string("\0\0\x80?", 4));  // exp(0)
  EXPECT_EQ(byte(24), 255);
  EXPECT_EQ(byte(25), 0);
  EXPECT_EQ(byte(26), 255);
  EXPECT_EQ(byte(27), 128);
  EXPECT_EQ(byte(28), 255);
  EXPECT_EQ(byte(29), 128);
}

TEST(SplatFile, BadValuesAreRefused) {
  const TemporaryFolder folder;
  auto splats = random_splats(3);
  splats[1].mean[2] = std::numeric_limits<float>::quiet_NaN();
  for (const Status& status :
       {save_splat_file(folder / "a.splat", splats), save_spz(folder / "a.spz", splats)}) {
    ASSERT_FALSE(status);
    EXPECT_THAT(status.error().message, HasSubstr("Gaussian 1"));
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "a.splat"));
}

TEST(Spz, RoundTrip) {
  const TemporaryFolder folder;
  const auto splats = random_splats(500);
  for (const auto& [version, bytes, angle] :
       {std::tuple(SpzVersion::kGzip, 19, 0.025), std::tuple(SpzVersion::kZstd, 20, 0.005)}) {
    ASSERT_TRUE(save_spz(folder / "a.spz", splats, {}, version));
    const auto read = load_spz(folder / "a.spz");
    ASSERT_TRUE(read) << read.error().text();
    const double color_step = 0.5 / 255 * kSh0 / 0.15;
    expect_near(read->gaussians, splats,
                {0.5 / 65536 + 1e-6, 1.0 / 32 + 1e-6, color_step + 1e-6, 0.5 / 255 + 1e-6, angle});
    EXPECT_LT(std::filesystem::file_size(folder / "a.spz"), 500 * bytes + 300);
  }
}

TEST(Spz, EveryComponentMayBeTheLargest) {
  const TemporaryFolder folder;
  std::vector<map::Gaussian> splats;
  for (int k = 0; k < 4; ++k) {
    for (const float sign : {-1.f, 1.f}) {
      map::Gaussian g{};
      for (int i = 0; i < 4; ++i) g.rotation[i] = 0.3f * static_cast<float>(i % 2 == 0 ? -1 : 1);
      g.rotation[k] = sign;
      splats.push_back(g);
    }
  }
  ASSERT_TRUE(save_spz(folder / "a.spz", splats));
  const auto read = load_spz(folder / "a.spz");
  ASSERT_TRUE(read);
  for (std::size_t i = 0; i < splats.size(); ++i) {
    const auto p = unit_rotation(splats[i]), q = unit_rotation(read->gaussians[i]);
    double dot = 0;
    for (std::size_t k = 0; k < 4; ++k) dot += p[k] * q[k];
    EXPECT_GT(std::abs(dot), 1 - 1e-5) << i;  // the rotation itself, not one like it
  }
}

// 32 bytes of header, a line of 16 for each stream that is not empty, and the streams.
TEST(Spz, LayoutOfVersion4) {
  const TemporaryFolder folder;
  const auto splats = random_splats(7);
  map::Harmonics harmonics{1, {}};
  harmonics.resize(splats.size());
  for (const bool with : {false, true}) {
    ASSERT_TRUE(save_spz(folder / "a.spz", splats, with ? harmonics : map::Harmonics{}));
    const std::string file = *read_file(folder / "a.spz");
    EXPECT_EQ(file.substr(0, 12), std::string("NGSP\4\0\0\0\7\0\0\0", 12));
    EXPECT_EQ(file[12], with ? 1 : 0);
    EXPECT_EQ(file[15], with ? 6 : 5);
    EXPECT_EQ(file.substr(16, 16), std::string(" ", 1) + std::string(15, '\0'));
    EXPECT_EQ(file[32 + 8], 9 * 7);  // positions
  }
}

TEST(Spz, DamagedFilesOfVersion4) {
  const TemporaryFolder folder;
  ASSERT_TRUE(save_spz(folder / "empty.spz", {}));
  EXPECT_TRUE(load_spz(folder / "empty.spz")->gaussians.empty());
  ASSERT_TRUE(save_spz(folder / "a.spz", random_splats(50)));
  const std::string whole = *read_file(folder / "a.spz");
  const auto with = [&](std::size_t at, char value) {
    std::string bad = whole;
    bad[at] = value;
    return bad;
  };
  for (const std::string& bad :
       {whole.substr(0, whole.size() - 1), whole + "x", whole.substr(0, 20), whole.substr(0, 50),
        with(4, 3), with(4, 5), with(8, 51), with(11, 127), with(12, 4), with(15, 6), with(15, 0),
        with(16, 31), with(19, 127), with(32, 1), with(39, 127), with(112, 'x')}) {
    ASSERT_TRUE(write_file(folder / "bad.spz", bad));
    const auto read = load_spz(folder / "bad.spz");
    ASSERT_FALSE(read);
    EXPECT_THAT(read.error().message, HasSubstr("bad.spz"));
  }
}

TEST(Zstd, RoundTripAndLimits) {
  std::string bytes;
  for (unsigned i = 0; i < 700'000; ++i) bytes += static_cast<char>(i * i >> 7);
  for (const std::string& text : {std::string(), std::string("x"), bytes}) {
    EXPECT_EQ(zstd_decompressed(zstd_compressed(text), text.size()), text);
  }
  const std::string frame = zstd_compressed(bytes);
  EXPECT_FALSE(zstd_decompressed(frame, bytes.size() - 1));
  EXPECT_FALSE(zstd_decompressed(frame, bytes.size() + 1));
  EXPECT_FALSE(zstd_decompressed(frame.substr(0, frame.size() / 2), bytes.size()));
  EXPECT_FALSE(zstd_decompressed(frame + frame, bytes.size()));
}

// Up is -y and back is -z there: what is odd in one of the two changes its sign.
TEST(Spz, HarmonicsRoundTripAndTurnWithTheAxes) {
  const TemporaryFolder folder;
  const auto splats = random_splats(20);
  for (int degree = 1; degree <= map::kMaxHarmonicDegree; ++degree) {
    map::Harmonics harmonics{degree, {}};
    harmonics.resize(splats.size());
    for (std::size_t i = 0; i < harmonics.coefficients.size(); ++i) {
      harmonics.coefficients[i] = 0.9f * std::sin(static_cast<float>(i));
    }
    ASSERT_TRUE(save_spz(folder / "h.spz", splats, harmonics, SpzVersion::kGzip));
    const auto read = load_spz(folder / "h.spz");
    ASSERT_TRUE(read) << read.error().text();
    ASSERT_EQ(read->harmonics.degree, degree);
    ASSERT_EQ(read->harmonics.size(), splats.size());
    for (std::size_t i = 0; i < harmonics.coefficients.size(); ++i) {
      EXPECT_NEAR(read->harmonics.coefficients[i], harmonics.coefficients[i], 0.5 / 128 + 1e-6);
    }
    const std::string content = *gzip_decompressed(*read_file(folder / "h.spz"), 1 << 20);
    EXPECT_EQ(content[12], degree);
    const auto stored = [&](std::size_t k) {  // red of the first splat
      return static_cast<unsigned char>(content[16 + 19 * splats.size() + 3 * k]) / 128.0 - 1;
    };
    EXPECT_NEAR(stored(0), -harmonics.of(0)[0], 0.01);  // -y
    EXPECT_NEAR(stored(1), -harmonics.of(0)[3], 0.01);  // z
    EXPECT_NEAR(stored(2), harmonics.of(0)[6], 0.01);   // -x
  }
}

TEST(Spz, LargeCoordinatesTakeFewerFractionalBits) {
  const TemporaryFolder folder;
  auto splats = random_splats(2);
  splats[0].mean[0] = -5000;
  ASSERT_TRUE(save_spz(folder / "a.spz", splats));
  const auto read = load_spz(folder / "a.spz");
  ASSERT_TRUE(read);
  EXPECT_NEAR(read->gaussians[0].mean[0], -5000, 1e-3);
  EXPECT_NEAR(read->gaussians[1].mean[0], splats[1].mean[0], 1e-3);
  splats[0].mean[0] = 1e9f;
  EXPECT_FALSE(save_spz(folder / "a.spz", splats));
}

TEST(Spz, EmptyMapAndDamagedFiles) {
  const TemporaryFolder folder;
  ASSERT_TRUE(save_spz(folder / "empty.spz", {}, {}, SpzVersion::kGzip));
  EXPECT_TRUE(load_spz(folder / "empty.spz")->gaussians.empty());
  ASSERT_TRUE(save_spz(folder / "a.spz", random_splats(50), {}, SpzVersion::kGzip));
  const std::string whole = *read_file(folder / "a.spz");
  const std::string content = *gzip_decompressed(whole, 1 << 20);
  std::string other_version = content, fewer = content.substr(0, content.size() - 1);
  other_version[4] = 3;
  for (const std::string& bad :
       {whole.substr(0, whole.size() / 2), std::string("hello"), std::string(),
        gzip_compressed("NGSP"), gzip_compressed(other_version), gzip_compressed(fewer)}) {
    ASSERT_TRUE(write_file(folder / "bad.spz", bad));
    const auto read = load_spz(folder / "bad.spz");
    ASSERT_FALSE(read);
    EXPECT_THAT(read.error().message, HasSubstr("bad.spz"));
  }
}

TEST(Gzip, RoundTripAndLimits) {
  std::string bytes;
  for (unsigned i = 0; i < 700'000; ++i) bytes += static_cast<char>(i * i >> 7);
  for (const std::string& text : {std::string(), std::string("x"), bytes}) {
    EXPECT_EQ(gzip_decompressed(gzip_compressed(text), text.size()), text);
  }
  EXPECT_FALSE(gzip_decompressed(gzip_compressed(bytes), bytes.size() - 1));
  EXPECT_EQ(gzip_compressed(bytes), gzip_compressed(bytes));
}

TEST(Colmap, PosesAreWorldToCameraAndPixelsMoveByHalf) {
  const TemporaryFolder folder;
  const PinholeCamera camera{640, 480, 500, 510, 319.5, 239.5};
  Vector6d xi;
  xi << 0.3, -0.2, 0.5, 1, 2, 3;
  const std::vector<ColmapImage> images = {{"a.png", SE3::exp(xi)}};
  const std::vector<ColoredPoint> points = {{{0.5f, -1, 2}, {1, 2, 255}}};
  ASSERT_TRUE(save_colmap_model(folder.path(), camera, images, points));
  const auto lines = [&](const char* name) {
    static std::string text;
    text = *read_file(folder / name);
    return content_lines(text);
  };
  EXPECT_EQ(lines("cameras.txt")[0].text, "1 PINHOLE 640 480 500 510 320 240");
  EXPECT_EQ(lines("points3D.txt")[0].text, "1 0.500000 -1.000000 2.000000 1 2 255 0");
  const auto image_lines = lines("images.txt");
  const auto fields = split_fields(image_lines[0].text);
  ASSERT_EQ(fields.size(), 10u);
  const auto number = [&](std::size_t i) { return *parse_double(fields[i]); };
  const Eigen::Quaterniond q(number(1), number(2), number(3), number(4));
  const SE3 T_camera_world(q, {number(5), number(6), number(7)});
  EXPECT_LT((T_camera_world * images[0].T_world_camera).log().norm(), 1e-7);
  EXPECT_EQ(fields[9], "a.png");
  EXPECT_FALSE(save_colmap_model(folder.path(), camera,
                                 std::vector<ColmapImage>{{"a b.png", SE3{}}}, points));
}

}  // namespace
}  // namespace sgs::io
