// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

namespace sgs::io {

enum class PlyType { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };

/// Bytes of one value in a binary body.
std::size_t ply_size(PlyType type);

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::kFloat32;
};

/// The part of a PLY header that describes its vertices.
struct PlyHeader {
  bool ascii = false;  ///< otherwise binary, little endian
  std::size_t vertices = 0;
  std::vector<PlyProperty> vertex_properties;
  std::size_t body_offset = 0;  ///< of the first vertex; elements after the vertices are ignored
};

/// Parses a PLY header (Turk, The PLY Polygon File Format, 1994). The vertices must be the first
/// element and hold no lists. The error is one clause, without the file's name.
tl::expected<PlyHeader, std::string> parse_ply_header(std::string_view content);

}  // namespace sgs::io
