// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/io/glb.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "sgs/io/atomic_file.h"
#include "sgs/io/splat_check.h"

namespace sgs::io {
namespace {

using nlohmann::json;

static_assert(std::endian::native == std::endian::little, "values are copied as they are");

constexpr const char* kExtension = "KHR_gaussian_splatting";
// Codes of glTF.
constexpr int kFloat = 5126, kByte = 5121, kVertexBuffer = 34962, kPoints = 0;

/// The binary chunk, and what glTF says of it: a view and an accessor for each attribute.
class Attributes {
 public:
  explicit Attributes(std::size_t count) : count_(count) {}

  /// An attribute of `width` floats per Gaussian, filled by `value(i, floats)`.
  template <class Value>
  json& add_floats(const std::string& name, std::size_t width, const Value& value) {
    const std::size_t size = sizeof(float) * width;
    json& accessor = begin(name, size, kFloat, width);
    float row[4] = {};
    for (std::size_t i = 0; i < count_; ++i) {
      value(i, row);
      std::memcpy(bytes_.data() + at_ + i * size, row, size);
    }
    return accessor;
  }
  /// An attribute of four bytes per Gaussian that stand for 0 to 1.
  template <class Value>
  void add_colors(const std::string& name, const Value& value) {
    begin(name, 4, kByte, 4)["normalized"] = true;
    for (std::size_t i = 0; i < count_; ++i) {
      for (std::size_t k = 0; k < 4; ++k) {
        const auto byte = std::lround(255 * std::clamp(value(i, k), 0.0, 1.0));
        bytes_[at_ + 4 * i + k] = static_cast<char>(static_cast<std::uint8_t>(byte));
      }
    }
  }

  const json& names() const { return names_; }
  const json& views() const { return views_; }
  const json& accessors() const { return accessors_; }
  const std::string& bytes() const { return bytes_; }

 private:
  json& begin(const std::string& name, std::size_t size, int type, std::size_t width) {
    static constexpr const char* kTypes[] = {"", "SCALAR", "VEC2", "VEC3", "VEC4"};
    at_ = bytes_.size();
    bytes_.resize(at_ + size * count_);  // rows are whole words: everything stays aligned
    names_[name] = accessors_.size();
    views_.push_back({{"buffer", 0},
                      {"byteOffset", at_},
                      {"byteLength", size * count_},
                      {"target", kVertexBuffer}});
    accessors_.push_back({{"bufferView", views_.size() - 1},
                          {"componentType", type},
                          {"count", count_},
                          {"type", kTypes[width]}});
    return accessors_.back();
  }

  std::size_t count_, at_ = 0;
  std::string bytes_;
  json names_ = json::object(), views_ = json::array(), accessors_ = json::array();
};

/// Readers of points want linear light; ours is as displayed.
double linear(double srgb) {
  const double v = std::clamp(srgb, 0.0, 1.0);
  return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}

void add_positions(Attributes& to, std::span<const map::Gaussian> splats) {
  std::array<float, 3> low, high;
  low.fill(std::numeric_limits<float>::max());
  high.fill(std::numeric_limits<float>::lowest());
  json& accessor = to.add_floats("POSITION", 3, [&](std::size_t i, float* row) {
    for (std::size_t k = 0; k < 3; ++k) {
      row[k] = splats[i].mean[k];
      low[k] = std::min(low[k], row[k]);
      high[k] = std::max(high[k], row[k]);
    }
  });
  accessor["min"] = low;
  accessor["max"] = high;
}

void add_shapes(Attributes& to, std::span<const map::Gaussian> splats) {
  const std::string prefix = std::string(kExtension) + ":";
  to.add_floats(prefix + "ROTATION", 4, [&](std::size_t i, float* row) {
    const auto wxyz = unit_rotation(splats[i]);
    for (std::size_t k = 0; k < 4; ++k) row[k] = static_cast<float>(wxyz[(k + 1) % 4]);
  });
  to.add_floats(prefix + "SCALE", 3, [&](std::size_t i, float* row) {
    for (std::size_t k = 0; k < 3; ++k) {
      row[k] = std::min(std::exp(splats[i].log_scale[k]), std::numeric_limits<float>::max());
    }
  });
  to.add_floats(prefix + "OPACITY", 1,
                [&](std::size_t i, float* row) { row[0] = map::opacity(splats[i]); });
}

void add_colors(Attributes& to, std::span<const map::Gaussian> splats,
                const map::Harmonics& harmonics) {
  to.add_colors("COLOR_0", [&](std::size_t i, std::size_t k) {
    return k < 3 ? linear(splats[i].rgb[k]) : map::opacity<double>(splats[i]);
  });
  const auto name = [](int degree, std::size_t n) {
    return fmt::format("{}:SH_DEGREE_{}_COEF_{}", kExtension, degree, n);
  };
  to.add_floats(name(0, 0), 3, [&](std::size_t i, float* row) {
    for (std::size_t k = 0; k < 3; ++k) {
      row[k] = static_cast<float>((splats[i].rgb[k] - 0.5) / kSh0);
    }
  });
  for (int degree = 1; degree <= harmonics.degree; ++degree) {
    const std::size_t before = map::Harmonics::basis_functions(degree - 1);
    const std::size_t end = map::Harmonics::basis_functions(degree);
    for (std::size_t function = before; function < end; ++function) {
      to.add_floats(name(degree, function - before), 3, [&](std::size_t i, float* row) {
        const auto own = harmonics.of(i).subspan(3 * function, 3);
        std::copy(own.begin(), own.end(), row);
      });
    }
  }
}

json document(const Attributes& attributes) {
  json primitive;
  primitive["mode"] = kPoints;
  primitive["attributes"] = attributes.names();
  primitive["extensions"][kExtension]["kernel"] = "ellipse";
  primitive["extensions"][kExtension]["colorSpace"] = "srgb_rec709_display";
  json out;
  out["asset"]["version"] = "2.0";
  out["asset"]["generator"] = "sgs";
  out["extensionsUsed"][0] = kExtension;
  out["scene"] = 0;
  out["scenes"][0]["nodes"][0] = 0;
  out["nodes"][0]["mesh"] = 0;
  out["meshes"][0]["primitives"][0] = std::move(primitive);
  out["buffers"][0]["byteLength"] = attributes.bytes().size();
  out["bufferViews"] = attributes.views();
  out["accessors"] = attributes.accessors();
  return out;
}

void append_word(std::string& out, std::size_t value) {
  const auto word = static_cast<std::uint32_t>(value);
  char bytes[sizeof word];
  std::memcpy(bytes, &word, sizeof word);
  out.append(bytes, sizeof word);
}

/// Header and two chunks, each padded to whole words: the document and the binary data.
Result<std::string> container(std::string text, const std::string& bytes) {
  constexpr std::size_t kMagic = 0x46546C67, kVersion = 2, kJson = 0x4E4F534A, kBinary = 0x004E4942;
  constexpr std::size_t kHeader = 12, kChunkHeader = 8, kWord = 4;
  text.resize((text.size() + kWord - 1) / kWord * kWord, ' ');
  const std::size_t size = kHeader + 2 * kChunkHeader + text.size() + bytes.size();
  if (size > std::numeric_limits<std::uint32_t>::max()) {
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{:.1f} GB are more than a .glb file can hold",
                            1e-9 * static_cast<double>(size)),
                "write .spz, which packs them");
  }
  std::string out;
  out.reserve(size);
  for (const std::size_t word : {kMagic, kVersion, size, text.size(), kJson})
    append_word(out, word);
  out += text;
  for (const std::size_t word : {bytes.size(), kBinary}) append_word(out, word);
  return out + bytes;
}

}  // namespace

Eigen::Matrix3d gltf_from_camera_axes() { return Eigen::Vector3d(1, -1, -1).asDiagonal(); }

Eigen::Matrix3d gltf_from_upright_axes() {
  Eigen::Matrix3d R;
  R << 0, 1, 0, 0, 0, 1, 1, 0, 0;
  return R;
}

Status save_glb(const std::filesystem::path& path, std::span<const map::Gaussian> splats,
                const map::Harmonics& harmonics) {
  SGS_RETURN_IF_ERROR(check_splats(path, splats, harmonics));
  if (splats.empty()) {
    return fail(
        ErrorCode::kInvalidArgument,
        fmt::format("{}: glTF has no way to say that there are no Gaussians", path.string()),
        "give the map of a run that saw something");
  }
  Attributes attributes(splats.size());
  add_positions(attributes, splats);
  add_shapes(attributes, splats);
  add_colors(attributes, splats, harmonics);
  SGS_ASSIGN_OR_RETURN(const std::string file,
                       container(document(attributes).dump(), attributes.bytes()));
  return write_file(path, file);
}

}  // namespace sgs::io
