// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/io/glb.h"

#include <gmock/gmock.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "sgs/io/atomic_file.h"
#include "sgs/io/splat_check.h"
#include "sgs/io/temporary_folder.h"

namespace sgs::io {
namespace {

using nlohmann::json;

/// A .glb file taken apart.
struct GlbParts {
  json document;
  std::string binary;

  /// Value `k` of row `i` of an attribute of floats.
  float at(const std::string& name, std::size_t i, std::size_t k) const {
    const auto& primitive = document["meshes"][0]["primitives"][0];
    const auto& accessor = document["accessors"][primitive["attributes"][name].get<std::size_t>()];
    const auto& view = document["bufferViews"][accessor["bufferView"].get<std::size_t>()];
    const auto rows = accessor["count"].get<std::size_t>();
    const std::size_t row = view["byteLength"].get<std::size_t>() / rows;
    float value = 0;
    std::memcpy(&value, binary.data() + view["byteOffset"].get<std::size_t>() + i * row + 4 * k, 4);
    return value;
  }
};

std::size_t glb_word(const std::string& bytes, std::size_t at) {
  std::uint32_t word = 0;
  std::memcpy(&word, bytes.data() + at, sizeof word);
  return word;
}

GlbParts glb_parts(const std::filesystem::path& path) {
  const std::string file = *read_file(path);
  EXPECT_EQ(file.substr(0, 8), std::string("glTF\2\0\0\0", 8));
  EXPECT_EQ(glb_word(file, 8), file.size());
  const std::size_t text = glb_word(file, 12);
  EXPECT_EQ(text % 4, 0u);
  EXPECT_EQ(file.substr(16, 4), "JSON");
  const std::size_t binary = glb_word(file, 20 + text);
  EXPECT_EQ(file.substr(24 + text, 4), std::string("BIN\0", 4));
  EXPECT_EQ(28 + text + binary, file.size());
  return {json::parse(file.substr(20, text)), file.substr(28 + text)};
}

std::vector<map::Gaussian> three_splats() {
  std::vector<map::Gaussian> splats(3);
  for (std::size_t i = 0; i < splats.size(); ++i) {
    const auto f = static_cast<float>(i);
    splats[i] = {.mean = {f, -2 * f, 0.1f},
                 .log_scale = {-3, -4, -5 + f},
                 .rotation = {0, 2, 0, 0},
                 .opacity_logit = f - 1,
                 .rgb = {1, 0.5f, -1},
                 .unused = {}};
  }
  return splats;
}

TEST(Glb, WhatItSays) {
  const TemporaryFolder folder;
  ASSERT_TRUE(save_glb(folder / "a.glb", three_splats()));
  const GlbParts parts = glb_parts(folder / "a.glb");
  EXPECT_EQ(parts.document["asset"]["version"], "2.0");
  EXPECT_EQ(parts.document["extensionsUsed"], json::array({"KHR_gaussian_splatting"}));
  EXPECT_EQ(parts.document["scenes"], json::parse(R"([{"nodes": [0]}])"));
  EXPECT_EQ(parts.document["nodes"], json::parse(R"([{"mesh": 0}])"));
  EXPECT_EQ(parts.document["buffers"][0]["byteLength"], parts.binary.size());
  const json& primitive = parts.document["meshes"][0]["primitives"][0];
  EXPECT_EQ(primitive["mode"], 0);
  EXPECT_EQ(primitive["extensions"]["KHR_gaussian_splatting"],
            json::parse(R"({"kernel": "ellipse", "colorSpace": "srgb_rec709_display"})"));
  const json& positions = parts.document["accessors"][0];
  EXPECT_EQ(positions["min"], json::array({0.0f, -4.0f, 0.1f}));
  EXPECT_EQ(positions["max"], json::array({2.0f, 0.0f, 0.1f}));
}

TEST(Glb, ValuesOfGaussians) {
  const TemporaryFolder folder;
  const auto splats = three_splats();
  ASSERT_TRUE(save_glb(folder / "a.glb", splats));
  const GlbParts parts = glb_parts(folder / "a.glb");
  const std::string prefix = "KHR_gaussian_splatting:";
  for (std::size_t i = 0; i < splats.size(); ++i) {
    EXPECT_EQ(parts.at("POSITION", i, 1), splats[i].mean[1]);
    EXPECT_EQ(parts.at(prefix + "ROTATION", i, 0), 1);  // x y z w
    EXPECT_EQ(parts.at(prefix + "ROTATION", i, 3), 0);
    EXPECT_FLOAT_EQ(parts.at(prefix + "SCALE", i, 2), std::exp(splats[i].log_scale[2]));
    EXPECT_FLOAT_EQ(parts.at(prefix + "OPACITY", i, 0), map::opacity(splats[i]));
    EXPECT_FLOAT_EQ(parts.at(prefix + "SH_DEGREE_0_COEF_0", i, 0), static_cast<float>(0.5 / kSh0));
  }
  // Points are in linear light, within what a byte holds: 1, (0.5 -> 0.214), 0.
  const json& primitive = parts.document["meshes"][0]["primitives"][0];
  const auto color = primitive["attributes"]["COLOR_0"].get<std::size_t>();
  const auto view = parts.document["accessors"][color]["bufferView"].get<std::size_t>();
  const auto offset = parts.document["bufferViews"][view]["byteOffset"].get<std::size_t>();
  EXPECT_EQ(parts.binary.substr(offset, 3), std::string("\xff\x37\0", 3));
}

TEST(Glb, HarmonicsByDegree) {
  const TemporaryFolder folder;
  const auto splats = three_splats();
  map::Harmonics harmonics{3, {}};
  harmonics.resize(splats.size());
  for (std::size_t i = 0; i < harmonics.coefficients.size(); ++i) {
    harmonics.coefficients[i] = static_cast<float>(i);
  }
  ASSERT_TRUE(save_glb(folder / "a.glb", splats, harmonics));
  const GlbParts parts = glb_parts(folder / "a.glb");
  std::size_t function = 0;
  for (int degree = 1; degree <= 3; ++degree) {
    for (int n = 0; n <= 2 * degree; ++n, ++function) {
      const auto name = fmt::format("KHR_gaussian_splatting:SH_DEGREE_{}_COEF_{}", degree, n);
      EXPECT_EQ(parts.at(name, 1, 2), harmonics.of(1)[3 * function + 2]);
    }
  }
  EXPECT_EQ(function, 15u);
}

TEST(Glb, AxesAreRotations) {
  for (const Eigen::Matrix3d& R : {gltf_from_camera_axes(), gltf_from_upright_axes()}) {
    EXPECT_NEAR(R.determinant(), 1, 1e-12);
    EXPECT_TRUE((R * R.transpose()).isIdentity(1e-12));
  }
  const Eigen::Vector3d up = Eigen::Vector3d::UnitY();
  EXPECT_EQ(gltf_from_camera_axes() * Eigen::Vector3d(0, -1, 0), up);
  EXPECT_EQ(gltf_from_upright_axes() * Eigen::Vector3d(0, 0, 1), up);
}

TEST(Glb, WhatCannotBeWritten) {
  const TemporaryFolder folder;
  EXPECT_FALSE(save_glb(folder / "a.glb", {}));
  auto splats = three_splats();
  splats[2].rgb[0] = std::nanf("");
  const Status status = save_glb(folder / "a.glb", splats);
  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().message, ::testing::HasSubstr("Gaussian 2"));
  EXPECT_FALSE(std::filesystem::exists(folder / "a.glb"));
}

}  // namespace
}  // namespace sgs::io
