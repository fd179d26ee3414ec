// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/io/foreign_content.h"

#include <fmt/format.h>

#include <algorithm>

#include "sgs/io/archive.h"
#include "sgs/io/text.h"

namespace sgs::io {
namespace {

using namespace std::string_view_literals;

constexpr std::size_t kTelling_bytes = 64;

struct Kind {
  std::string_view begins;
  const char* what;
};

constexpr Kind kPictures[] = {
    {"BM", "a BMP picture"},           {"II*\0"sv, "a TIFF picture"},
    {"MM\0*"sv, "a TIFF picture"},     {"GIF8", "a GIF picture"},
    {"v/1\x01", "an OpenEXR picture"}, {"\x93NUMPY", "an array of NumPy"},
    {"P5", "a PGM picture"},           {"P6", "a PPM picture"},
    {"Pf", "a PFM picture"},
};

/// Archives and the ending that says so.
struct Archive {
  std::string_view begins;
  const char* ending;
};
constexpr Archive kArchives[] = {
    {"PK\x03\x04", ".zip"},
    {"\x1F\x8B", ".gz"},
    {"7z\xBC\xAF\x27\x1C", ".7z"},
    {"Rar!", ".rar"},
    {"BZh", ".bz2"},
    {"\x28\xB5\x2F\xFD", ".zst"},
    {"\xFD"
     "7zXZ",
     ".xz"},
    {"\x04\x22\x4D\x18", ".lz4"},
};

}  // namespace

std::optional<ForeignContent> foreign_content(std::string_view bytes,
                                              const std::filesystem::path& path) {
  if (bytes.empty()) {
    return ForeignContent{"empty, a file of 0 bytes", "copy, download or record it again"};
  }
  const std::string text = lower_case(std::string(bytes.substr(0, kTelling_bytes)));
  if (text.starts_with("version https://git-lfs")) {
    return ForeignContent{"a pointer of Git LFS, not the file itself",
                          "fetch the files with `git lfs pull` in that repository"};
  }
  const auto first = text.find_first_not_of(" \t\r\n");
  const std::string_view page =
      first == std::string::npos ? ""sv : std::string_view(text).substr(first);
  if (page.starts_with("<!doctype html") || page.starts_with("<html")) {
    return ForeignContent{"a web page, not the file itself", "download it again"};
  }
  if (bytes.starts_with("RIFF") && bytes.substr(0, 12).ends_with("WEBP")) {
    return ForeignContent{"a WebP picture", "convert the images to PNG or JPEG"};
  }
  for (const Kind& kind : kPictures) {
    if (bytes.starts_with(kind.begins)) {
      return ForeignContent{kind.what, "convert the images to PNG or JPEG, depth to 16-bit PNG"};
    }
  }
  for (const Archive& archive : kArchives) {
    if (!bytes.starts_with(archive.begins)) continue;
    const std::string name = path.string() + archive.ending;
    return ForeignContent{fmt::format("packed ({})", archive.ending),
                          path.empty()
                              ? std::string("unpack it first")
                              : fmt::format("give it its ending and then the new name: `mv {} {}`",
                                            shell_quoted(path), shell_quoted(name))};
  }
  return std::nullopt;
}

}  // namespace sgs::io
