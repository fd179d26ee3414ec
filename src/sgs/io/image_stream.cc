// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/io/image_stream.h"

#include <fmt/format.h>
#include <libdeflate.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace sgs::io {
namespace {

constexpr std::string_view kPngSignature = "\x89PNG\r\n\x1a\n";

std::uint32_t byte_at(std::string_view bytes, std::size_t i) {
  return static_cast<unsigned char>(bytes[i]);
}
std::uint32_t big_endian(std::string_view bytes, std::size_t i, int count) {
  std::uint32_t value = 0;
  for (int k = 0; k < count; ++k) {
    value = value << 8 | byte_at(bytes, i + static_cast<std::size_t>(k));
  }
  return value;
}

StreamCheck check_png(std::string_view bytes) {
  StreamCheck result{StreamCheck::Kind::kPng, 8, ""};
  constexpr std::size_t kChunkFrame = 12;  // length, type, CRC
  bool has_pixels = false;
  std::size_t at = kPngSignature.size();
  while (bytes.size() - at >= kChunkFrame) {
    const std::size_t length = big_endian(bytes, at, 4);
    const std::string_view type = bytes.substr(at + 4, 4);
    if (length > bytes.size() - at - kChunkFrame) break;
    // libpng finds this too, but tells the terminal about it.
    if (libdeflate_crc32(0, bytes.data() + at + 4, 4 + length) !=
        big_endian(bytes, at + 8 + length, 4)) {
      result.problem = fmt::format("damaged PNG: wrong checksum at byte {}", at);
      return result;
    }
    if (type == "IHDR" && at > kPngSignature.size()) {
      // Decoders go by the first one: a second one must not hide how large the image is.
      result.problem = fmt::format("damaged PNG: a second header at byte {}", at);
      return result;
    }
    if (type == "IHDR" && length >= 9) {
      result.width = static_cast<int>(big_endian(bytes, at + 8, 4) & 0x7fffffff);
      result.height = static_cast<int>(big_endian(bytes, at + 12, 4) & 0x7fffffff);
      result.bits_per_channel = static_cast<int>(byte_at(bytes, at + 8 + 8));
    }
    has_pixels = has_pixels || type == "IDAT";
    if (type == "IEND") {
      if (!has_pixels) result.problem = "PNG without pixels";
      return result;
    }
    at += kChunkFrame + length;
  }
  result.problem = fmt::format("truncated PNG: it ends after {} bytes without IEND", bytes.size());
  return result;
}

/// The orientation that an Exif segment says (Exif 2.32, 4.6.2 and 4.6.4); 1 where it says none.
int orientation_of(std::string_view segment) {
  constexpr std::string_view kExif("Exif\0\0", 6);
  constexpr std::size_t kOrientation = 0x0112, kEntry_bytes = 12, kMostEntries = 512;
  if (!segment.starts_with(kExif)) return 1;
  const std::string_view tiff = segment.substr(kExif.size());
  const bool little = tiff.starts_with("II");
  const auto number = [&](std::size_t at, std::size_t bytes) -> std::size_t {
    std::size_t value = 0;
    for (std::size_t i = 0; i < bytes; ++i) {
      const std::size_t from = little ? at + bytes - 1 - i : at + i;
      value = value << 8 | (from < tiff.size() ? byte_at(tiff, from) : 0);
    }
    return value;
  };
  const std::size_t directory = number(4, 4),
                    entries = std::min(number(directory, 2), kMostEntries);
  for (std::size_t i = 0; i < entries; ++i) {
    const std::size_t at = directory + 2 + i * kEntry_bytes;
    if (number(at, 2) != kOrientation) continue;
    const std::size_t value = number(at + 8, 2);
    return value >= 1 && value <= 8 ? static_cast<int>(value) : 1;
  }
  return 1;
}

StreamCheck check_jpeg(std::string_view bytes) {
  StreamCheck result{StreamCheck::Kind::kJpeg, 8, ""};
  constexpr std::uint32_t kEndOfImage = 0xD9, kStartOfScan = 0xDA;
  bool has_scan = false;
  std::size_t at = 2;
  while (true) {
    // Inside entropy-coded data FF 00 is a stuffed FF and FF D0..D7 a restart; anything else after
    // FF is the next marker. Outside it, this loop stops at the marker at once.
    while (at + 1 < bytes.size()) {
      const std::uint32_t code = byte_at(bytes, at + 1);
      const bool marker = byte_at(bytes, at) == 0xFF && code != 0x00 && code != 0xFF &&
                          !(code >= 0xD0 && code <= 0xD7);
      if (marker) break;
      ++at;
    }
    if (at + 1 >= bytes.size()) break;
    const std::uint32_t code = byte_at(bytes, at + 1);
    if (code == kEndOfImage) {
      if (!has_scan) result.problem = "JPEG without pixels";
      return result;
    }
    if (at + 4 > bytes.size()) break;
    const std::size_t length = big_endian(bytes, at + 2, 2);
    const bool frame_header =
        code >= 0xC0 && code <= 0xCF && code != 0xC4 && code != 0xC8 && code != 0xCC;
    if (frame_header && result.width > 0) {  // as above
      result.problem = fmt::format("damaged JPEG: a second header at byte {}", at);
      return result;
    }
    if (frame_header && at + 9 <= bytes.size()) {
      result.height = static_cast<int>(big_endian(bytes, at + 5, 2));
      result.width = static_cast<int>(big_endian(bytes, at + 7, 2));
      result.bits_per_channel = static_cast<int>(byte_at(bytes, at + 4));
    }
    has_scan = has_scan || code == kStartOfScan;
    if (length < 2 || length > bytes.size() - at - 2) break;
    constexpr std::uint32_t kApplication1 = 0xE1;
    if (code == kApplication1 && result.orientation == 1) {
      result.orientation = orientation_of(bytes.substr(at + 4, length - 2));
    }
    at += 2 + length;
  }
  result.problem = fmt::format("truncated JPEG: it ends after {} bytes without EOI", bytes.size());
  return result;
}

}  // namespace

StreamCheck check_image_stream(std::string_view bytes) {
  if (bytes.empty()) return {StreamCheck::Kind::kUnknown, 0, "the file is empty (0 bytes)"};
  if (bytes.starts_with(kPngSignature)) return check_png(bytes);
  if (bytes.starts_with("\xFF\xD8")) return check_jpeg(bytes);
  if (kPngSignature.starts_with(bytes) || bytes == "\xFF") {
    return {StreamCheck::Kind::kUnknown, 0,
            fmt::format("truncated image of {} bytes", bytes.size())};
  }
  return {};
}

}  // namespace sgs::io
