// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/io/plain_png.h"

#include <libdeflate.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <memory>
#include <vector>

#include "sgs/io/png_filter.h"

namespace sgs::io {
namespace {

constexpr std::string_view kSignatureOfPng = "\x89PNG\r\n\x1a\n";
constexpr std::size_t kLargestSide_px = 1'000'000;  ///< as libpng has it
/// What one byte of deflate can become at most: a match of 258 bytes takes two bits.
constexpr std::size_t kLargestExpansion = 1032;

std::size_t number32(std::string_view bytes, std::size_t at) {
  std::size_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<std::uint8_t>(bytes[at + i]);
  return value;
}

/// The parts of a PNG that make its pixels.
struct PlainPng {
  std::size_t width = 0, height = 0;
  std::vector<std::string_view> deflated;  ///< what its IDAT chunks hold

  std::size_t deflated_size() const {
    std::size_t size = 0;
    for (const std::string_view part : deflated) size += part.size();
    return size;
  }
};

/// IHDR of a picture of that depth and colour type, not interlaced.
bool read_header(std::string_view data, std::uint8_t bits, std::uint8_t color_type, PlainPng& png) {
  const char rest[] = {static_cast<char>(bits), static_cast<char>(color_type), 0, 0, 0};
  if (data.size() != 8 + sizeof rest || data.substr(8) != std::string_view(rest, sizeof rest)) {
    return false;
  }
  png.width = number32(data, 0);
  png.height = number32(data, 4);
  return png.width >= 1 && png.height >= 1 && png.width <= kLargestSide_px &&
         png.height <= kLargestSide_px;
}

/// Whether a chunk can be passed over: four letters, the first one small.
bool is_ancillary(std::string_view type) {
  const auto is_between = [](char c, char first, char last) { return c >= first && c <= last; };
  return is_between(type[0], 'a', 'z') && std::all_of(type.begin(), type.end(), [&](char c) {
           return is_between(c, 'a', 'z') || is_between(c, 'A', 'Z');
         });
}

/// Walks the chunks: IHDR, what can be passed over, IDAT without a gap, what can be passed over,
/// IEND.
std::optional<PlainPng> read_chunks(std::string_view bytes, std::uint8_t bits,
                                    std::uint8_t color_type) {
  constexpr std::size_t kFrame = 12;  // length, type, CRC
  if (!bytes.starts_with(kSignatureOfPng)) return std::nullopt;
  PlainPng png;
  std::string_view previous;
  for (std::size_t at = kSignatureOfPng.size(); bytes.size() - at >= kFrame;) {
    const std::size_t length = number32(bytes, at);
    if (length > bytes.size() - at - kFrame) return std::nullopt;
    const std::string_view type = bytes.substr(at + 4, 4), data = bytes.substr(at + 8, length);
    const bool first = at == kSignatureOfPng.size();
    if (first != (type == "IHDR")) return std::nullopt;
    if (first) {
      if (!read_header(data, bits, color_type, png)) return std::nullopt;
    } else if (type == "IDAT") {
      if (!png.deflated.empty() && previous != "IDAT") return std::nullopt;
      png.deflated.push_back(data);
    } else if (type == "IEND") {
      if (png.deflated.empty() || length != 0) return std::nullopt;
      return png;
    } else if (!is_ancillary(type)) {
      return std::nullopt;
    }
    previous = type;
    at += kFrame + length;
  }
  return std::nullopt;
}

using Buffer = std::unique_ptr<std::uint8_t[]>;

/// Inflates to exactly `size` bytes, with room for `padding` more behind them; null where the
/// stream is damaged, has another size or does not end where its chunks do.
Buffer inflate_all(const PlainPng& png, std::size_t size, std::size_t padding) {
  const std::size_t deflated_size = png.deflated_size();
  if (size / kLargestExpansion > deflated_size) return nullptr;
  Buffer joined;
  const void* in = png.deflated.front().data();
  if (png.deflated.size() > 1) {
    joined = std::make_unique_for_overwrite<std::uint8_t[]>(deflated_size);
    auto* end = joined.get();
    for (const std::string_view part : png.deflated) {
      end = std::copy(part.begin(), part.end(), end);
    }
    in = joined.get();
  }
  auto out = std::make_unique_for_overwrite<std::uint8_t[]>(size + padding);
  std::memset(out.get() + size, 0, padding);
  const std::unique_ptr<libdeflate_decompressor, decltype(&libdeflate_free_decompressor)> inflater(
      libdeflate_alloc_decompressor(), libdeflate_free_decompressor);
  std::size_t used = 0, made = 0;
  const bool well = inflater != nullptr &&
                    libdeflate_zlib_decompress_ex(inflater.get(), in, deflated_size, out.get(),
                                                  size, &used, &made) == LIBDEFLATE_SUCCESS &&
                    used == deflated_size && made == size;
  return well ? std::move(out) : nullptr;
}

/// The pixels of a PNG as the file orders their bytes.
template <class Pixel>
std::optional<Image<Pixel>> decode_plain(std::string_view bytes, std::uint8_t bits,
                                         std::uint8_t color_type) {
  const auto png = read_chunks(bytes, bits, color_type);
  if (!png) return std::nullopt;
  const std::size_t row_bytes = sizeof(Pixel) * png->width;
  const Buffer rows = inflate_all(*png, (1 + row_bytes) * png->height, kPngRowPadding);
  if (rows == nullptr) return std::nullopt;
  Image<Pixel> image(static_cast<int>(png->width), static_cast<int>(png->height));
  auto* out = reinterpret_cast<std::uint8_t*>(image.data());
  if (!unfilter_png(rows.get(), png->height, row_bytes, sizeof(Pixel), out)) return std::nullopt;
  return image;
}

}  // namespace

std::optional<ColorImage> decode_plain_png_color(std::string_view bytes) {
  constexpr std::uint8_t kBits = 8, kRgb = 2;
  static_assert(sizeof(Rgb8) == 3);
  return decode_plain<Rgb8>(bytes, kBits, kRgb);
}

std::optional<Image<std::uint16_t>> decode_plain_png_grey16(std::string_view bytes) {
  constexpr std::uint8_t kBits = 16, kGrey = 0;
  auto image = decode_plain<std::uint16_t>(bytes, kBits, kGrey);
  if (!image || std::endian::native == std::endian::big) return image;
  std::transform(image->data(), image->data() + image->size(), image->data(), [](unsigned value) {
    return static_cast<std::uint16_t>(value << 8 | value >> 8);
  });
  return image;
}

}  // namespace sgs::io
