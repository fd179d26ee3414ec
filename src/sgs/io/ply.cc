// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/io/ply.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "sgs/io/atomic_file.h"
#include "sgs/io/ply_header.h"
#include "sgs/io/splat_check.h"
#include "sgs/io/text.h"

namespace sgs::io {
namespace fs = std::filesystem;
namespace {

static_assert(std::endian::native == std::endian::little, "PLY bodies are copied as they are");

// The sigmoid of this differs from 1 by one float step; tools that store opacity in eight bits
// write the logit of 0 and 1 as infinities.
constexpr float kMaxLogit = 16;
constexpr std::size_t kOpacity = 6;

// Needed properties, in the order in which Row holds them.
constexpr std::array<const char*, 14> kNames = {
    "x",       "y",       "z",       "f_dc_0", "f_dc_1", "f_dc_2", "opacity",
    "scale_0", "scale_1", "scale_2", "rot_0",  "rot_1",  "rot_2",  "rot_3"};
using Row = std::array<double, kNames.size()>;

tl::unexpected<Error> bad_file(const fs::path& path, const std::string& what) {
  return fail(ErrorCode::kInvalidFormat, fmt::format("{}: {}", path.string(), what),
              "needed: a PLY with the vertex layout of 3D Gaussian Splatting");
}

map::Gaussian gaussian_from(const Row& v) {
  const auto f = [&](std::size_t i) { return static_cast<float>(v[i]); };
  const auto rgb = [&](std::size_t i) { return static_cast<float>(0.5 + kSh0 * v[i]); };
  return {{f(0), f(1), f(2)},           {f(7), f(8), f(9)},
          {f(10), f(11), f(12), f(13)}, std::clamp(f(kOpacity), -kMaxLogit, kMaxLogit),
          {rgb(3), rgb(4), rgb(5)},     {0, 0}};
}

Status check_row(const fs::path& path, const Row& row, std::size_t vertex) {
  for (std::size_t i = 0; i < row.size(); ++i) {
    const auto value = static_cast<float>(row[i]);
    if (!std::isfinite(value) && !(i == kOpacity && std::isinf(value))) {
      return bad_file(path, fmt::format("vertex {}: {} is {}", vertex, kNames[i], row[i]));
    }
  }
  if (row[10] == 0 && row[11] == 0 && row[12] == 0 && row[13] == 0) {
    return bad_file(path, fmt::format("vertex {}: the rotation is zero", vertex));
  }
  return {};
}

/// Where in a vertex the properties that are needed stand.
struct Columns {
  std::array<std::size_t, kNames.size()> needed{};
  int degree = 0;                 // of the harmonics
  std::vector<std::size_t> rest;  // in the order of map::Harmonics
};

std::optional<std::size_t> column_of(const PlyHeader& header, std::string_view name) {
  const auto& properties = header.vertex_properties;
  const auto found = std::find_if(properties.begin(), properties.end(),
                                  [&](const PlyProperty& p) { return p.name == name; });
  if (found == properties.end()) return std::nullopt;
  return static_cast<std::size_t>(found - properties.begin());
}

/// The file has one channel after the other, map::Harmonics one function after the other.
std::size_t rest_number(std::size_t function, std::size_t channel, int degree) {
  return channel * map::Harmonics::basis_functions(degree) + function;
}

Result<Columns> find_columns(const fs::path& path, const PlyHeader& header) {
  Columns columns;
  for (std::size_t k = 0; k < kNames.size(); ++k) {
    const auto column = column_of(header, kNames[k]);
    if (!column) return bad_file(path, fmt::format("vertex property '{}' is missing", kNames[k]));
    columns.needed[k] = *column;
  }
  std::vector<std::size_t> rest;
  while (const auto column = column_of(header, fmt::format("f_rest_{}", rest.size()))) {
    rest.push_back(*column);
  }
  for (int degree = 1; degree <= map::kMaxHarmonicDegree; ++degree) {
    if (rest.size() == 3 * map::Harmonics::basis_functions(degree)) columns.degree = degree;
  }
  for (std::size_t k = 0; k < map::Harmonics::basis_functions(columns.degree); ++k) {
    for (std::size_t c = 0; c < 3; ++c) {
      columns.rest.push_back(rest[rest_number(k, c, columns.degree)]);
    }
  }
  return columns;
}

/// Adds vertex number `vertex`, whose numbers `value_at` gives by column.
template <class ValueAt>
Status add_vertex(const fs::path& path, const Columns& columns, std::size_t vertex,
                  const ValueAt& value_at, map::SplatMap& splats) {
  Row row;
  for (std::size_t k = 0; k < row.size(); ++k) row[k] = value_at(columns.needed[k]);
  SGS_RETURN_IF_ERROR(check_row(path, row, vertex));
  for (const std::size_t column : columns.rest) {
    const auto value = static_cast<float>(value_at(column));
    if (!std::isfinite(value)) {
      return bad_file(path, fmt::format("vertex {}: f_rest is {}", vertex, value));
    }
    splats.harmonics.coefficients.push_back(value);
  }
  splats.gaussians.push_back(gaussian_from(row));
  return {};
}

template <class T>
double load_as(const char* at) {
  T value;
  std::memcpy(&value, at, sizeof value);
  return static_cast<double>(value);
}

double load_scalar(PlyType type, const char* at) {
  switch (type) {
    case PlyType::kInt8:
      return load_as<std::int8_t>(at);
    case PlyType::kUint8:
      return load_as<std::uint8_t>(at);
    case PlyType::kInt16:
      return load_as<std::int16_t>(at);
    case PlyType::kUint16:
      return load_as<std::uint16_t>(at);
    case PlyType::kInt32:
      return load_as<std::int32_t>(at);
    case PlyType::kUint32:
      return load_as<std::uint32_t>(at);
    case PlyType::kFloat32:
      return load_as<float>(at);
    case PlyType::kFloat64:
      return load_as<double>(at);
  }
  return 0;
}

Result<map::SplatMap> read_binary(const fs::path& path, const PlyHeader& header,
                                  const Columns& columns, std::string_view body) {
  std::vector<std::size_t> offsets;
  std::size_t stride = 0;
  for (const PlyProperty& property : header.vertex_properties) {
    offsets.push_back(stride);
    stride += ply_size(property.type);
  }
  SGS_CHECK(stride > 0, "a header with the columns that were found");
  if (header.vertices > body.size() / stride) {
    return bad_file(path, fmt::format("truncated: {} vertices announced, {} present",
                                      header.vertices, body.size() / stride));
  }
  map::SplatMap splats{{}, {columns.degree, {}}};
  splats.gaussians.reserve(header.vertices);
  for (std::size_t i = 0; i < header.vertices; ++i) {
    const auto value_at = [&](std::size_t column) {
      return load_scalar(header.vertex_properties[column].type,
                         body.data() + i * stride + offsets[column]);
    };
    SGS_RETURN_IF_ERROR(add_vertex(path, columns, i, value_at, splats));
  }
  return splats;
}

Result<map::SplatMap> read_ascii(const fs::path& path, const PlyHeader& header,
                                 const Columns& columns, std::string_view body) {
  const auto lines = content_lines(body);
  if (lines.size() < header.vertices) {
    return bad_file(path, fmt::format("truncated: {} vertices announced, {} present",
                                      header.vertices, lines.size()));
  }
  map::SplatMap splats{{}, {columns.degree, {}}};
  splats.gaussians.reserve(header.vertices);
  for (std::size_t i = 0; i < header.vertices; ++i) {
    const auto fields = split_fields(lines[i].text);
    bool good = fields.size() == header.vertex_properties.size();
    const auto value_at = [&](std::size_t column) {
      const auto value = good ? parse_double(fields[column]) : std::nullopt;
      good = value.has_value();
      return value.value_or(1);
    };
    const Status added = add_vertex(path, columns, i, value_at, splats);
    if (!good) {
      return bad_file(path,
                      fmt::format("vertex {}: {} numbers needed, found '{}'", i,
                                  header.vertex_properties.size(), lines[i].text.substr(0, 80)));
    }
    SGS_RETURN_IF_ERROR(added);
  }
  return splats;
}

void append_float(std::string& out, double value) {
  const auto f = static_cast<float>(value);
  char bytes[sizeof f];
  std::memcpy(bytes, &f, sizeof f);
  out.append(bytes, sizeof f);
}

void append_point(std::string& out, const ColoredPoint& point) {
  for (int k = 0; k < 3; ++k) append_float(out, point.position[k]);
  for (const std::uint8_t c : {point.color.r, point.color.g, point.color.b}) {
    out += static_cast<char>(c);
  }
}

}  // namespace

Result<map::SplatMap> load_splats(const fs::path& path) {
  SGS_ASSIGN_OR_RETURN(const std::string content, read_file(path));
  const auto header = parse_ply_header(content);
  if (!header) return bad_file(path, header.error());
  SGS_ASSIGN_OR_RETURN(const Columns columns, find_columns(path, *header));
  const std::string_view body = std::string_view(content).substr(header->body_offset);
  return header->ascii ? read_ascii(path, *header, columns, body)
                       : read_binary(path, *header, columns, body);
}

namespace {

void append_splat(std::string& out, const map::Gaussian& g, const map::Harmonics& harmonics,
                  std::size_t number) {
  for (const float v : g.mean) append_float(out, v);
  for (int k = 0; k < 3; ++k) append_float(out, 0);
  for (const float v : g.rgb) append_float(out, (double{v} - 0.5) / kSh0);
  if (!harmonics.empty()) {
    const auto coefficients = harmonics.of(number);
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t k = c; k < coefficients.size(); k += 3) append_float(out, coefficients[k]);
    }
  }
  append_float(out, g.opacity_logit);
  for (const float v : g.log_scale) append_float(out, v);
  for (const double v : unit_rotation(g)) append_float(out, v);
}

std::string splat_header(std::size_t vertices, const map::Harmonics& harmonics) {
  std::string out =
      fmt::format("ply\nformat binary_little_endian 1.0\nelement vertex {}\n", vertices);
  const auto add = [&](std::string_view name) { out += fmt::format("property float {}\n", name); };
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz", "f_dc_0", "f_dc_1", "f_dc_2"})
    add(name);
  for (std::size_t k = 0; k < harmonics.floats(); ++k) add(fmt::format("f_rest_{}", k));
  for (const char* name :
       {"opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"}) {
    add(name);
  }
  return out + "end_header\n";
}

}  // namespace

Status save_splats(const fs::path& path, std::span<const map::Gaussian> splats,
                   const map::Harmonics& harmonics) {
  SGS_RETURN_IF_ERROR(check_splats(path, splats, harmonics));
  std::string block = splat_header(splats.size(), harmonics);
  // In blocks: a map is written where memory has run out, too.
  constexpr std::size_t kBlock_bytes = 1 << 15;
  bool begun = false;
  std::size_t next = 0;
  return write_file_in_blocks(path, [&]() -> std::string_view {
    if (std::exchange(begun, true)) block.clear();
    for (; next < splats.size() && block.size() < kBlock_bytes; ++next) {
      append_splat(block, splats[next], harmonics, next);
    }
    return block;
  });
}

Status save_points(const fs::path& path, std::span<const ColoredPoint> points) {
  std::string out = fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float "
      "y\nproperty float z\nproperty uchar red\nproperty uchar green\nproperty uchar "
      "blue\nend_header\n",
      points.size());
  for (const ColoredPoint& point : points) append_point(out, point);
  return write_file(path, out);
}

Status save_mesh(const fs::path& path, std::span<const ColoredPoint> vertices,
                 std::span<const std::array<std::uint32_t, 3>> triangles) {
  std::string out = fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float "
      "y\nproperty float z\nproperty uchar red\nproperty uchar green\nproperty uchar "
      "blue\nelement face {}\nproperty list uchar uint vertex_indices\nend_header\n",
      vertices.size(), triangles.size());
  for (const ColoredPoint& vertex : vertices) append_point(out, vertex);
  for (const auto& triangle : triangles) {
    out += '\3';
    for (const std::uint32_t index : triangle) {
      SGS_CHECK(index < vertices.size(), "a triangle names a vertex that does not exist");
      char bytes[sizeof index];
      std::memcpy(bytes, &index, sizeof index);
      out.append(bytes, sizeof index);
    }
  }
  return write_file(path, out);
}

}  // namespace sgs::io
