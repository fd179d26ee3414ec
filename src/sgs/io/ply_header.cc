// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/io/ply_header.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <optional>
#include <utility>

#include "sgs/io/text.h"

namespace sgs::io {
namespace {

std::optional<PlyType> type_named(std::string_view name) {
  using Entry = std::pair<std::string_view, PlyType>;
  static constexpr std::array<Entry, 16> kTypes = {{{"char", PlyType::kInt8},
                                                    {"int8", PlyType::kInt8},
                                                    {"uchar", PlyType::kUint8},
                                                    {"uint8", PlyType::kUint8},
                                                    {"short", PlyType::kInt16},
                                                    {"int16", PlyType::kInt16},
                                                    {"ushort", PlyType::kUint16},
                                                    {"uint16", PlyType::kUint16},
                                                    {"int", PlyType::kInt32},
                                                    {"int32", PlyType::kInt32},
                                                    {"uint", PlyType::kUint32},
                                                    {"uint32", PlyType::kUint32},
                                                    {"float", PlyType::kFloat32},
                                                    {"float32", PlyType::kFloat32},
                                                    {"double", PlyType::kFloat64},
                                                    {"float64", PlyType::kFloat64}}};
  for (const auto& [known, type] : kTypes) {
    if (known == name) return type;
  }
  return std::nullopt;
}

using Fields = std::vector<std::string_view>;

/// Understands one line of the header; returns what is wrong with it, if anything.
class HeaderParser {
 public:
  std::string line(const Fields& f) {
    if (f[0] == "format") return format(f);
    if (f[0] == "element") return element(f);
    if (f[0] == "property") return property(f);
    return f[0] == "comment" || f[0] == "obj_info" ? "" : fmt::format("unknown entry '{}'", f[0]);
  }
  std::string finish() const {
    if (!has_format_) return "the header has no format";
    if (header.vertex_properties.empty()) return "the header declares no vertices";
    return "";
  }
  PlyHeader header;

 private:
  std::string format(const Fields& f) {
    has_format_ = true;
    if (f.size() < 2) return "format without a name";
    header.ascii = f[1] == "ascii";
    if (header.ascii || f[1] == "binary_little_endian") return "";
    return fmt::format("format '{}' is not supported (ascii and binary_little_endian are)", f[1]);
  }
  std::string element(const Fields& f) {
    if (f.size() != 3) return "malformed element";
    in_vertices_ = f[1] == "vertex";
    if (!in_vertices_) return seen_vertices_ ? "" : "vertices must be the first element";
    seen_vertices_ = true;
    const auto end = f[2].data() + f[2].size();
    const auto result = std::from_chars(f[2].data(), end, header.vertices);
    const bool good = result.ec == std::errc{} && result.ptr == end;
    return good ? "" : fmt::format("'{}' is not a number of vertices", f[2]);
  }
  std::string property(const Fields& f) {
    if (!in_vertices_) return "";
    const auto type = f.size() == 3 ? type_named(f[1]) : std::nullopt;
    if (!type) return "vertex properties must be scalars of a known type";
    header.vertex_properties.push_back({std::string(f[2]), *type});
    return "";
  }

  bool has_format_ = false, in_vertices_ = false, seen_vertices_ = false;
};

}  // namespace

std::size_t ply_size(PlyType type) {
  switch (type) {
    case PlyType::kInt8:
    case PlyType::kUint8:
      return 1;
    case PlyType::kInt16:
    case PlyType::kUint16:
      return 2;
    case PlyType::kInt32:
    case PlyType::kUint32:
    case PlyType::kFloat32:
      return 4;
    case PlyType::kFloat64:
      return 8;
  }
  return 0;
}

tl::expected<PlyHeader, std::string> parse_ply_header(std::string_view content) {
  if (!content.starts_with("ply\n") && !content.starts_with("ply\r\n")) {
    return tl::unexpected<std::string>("not a PLY file");
  }
  HeaderParser parser;
  std::size_t at = content.find('\n') + 1;
  while (true) {
    const auto end = content.find('\n', at);
    if (end == std::string_view::npos) return tl::unexpected<std::string>("truncated header");
    const auto fields = split_fields(content.substr(at, end - at));
    at = end + 1;
    if (fields.empty()) continue;
    if (fields[0] == "end_header") break;
    if (auto problem = parser.line(fields); !problem.empty()) {
      return tl::unexpected<std::string>(std::move(problem));
    }
  }
  if (auto problem = parser.finish(); !problem.empty()) {
    return tl::unexpected<std::string>(std::move(problem));
  }
  parser.header.body_offset = at;
  return parser.header;
}

}  // namespace sgs::io
