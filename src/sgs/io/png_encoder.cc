// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <png.h>
#include <zlib.h>

#include <array>
#include <bit>
#include <csetjmp>
#include <new>
#include <utility>

#include "sgs/io/image_encoder.h"

namespace sgs::io {
namespace {

/// What libpng's callbacks see. libpng leaves its functions by longjmp: everything that owns memory
/// lives here, outside of the functions that are left.
struct PngEncoding {
  std::string bytes;
  std::array<char, 100> problem{};
  png_structp png = nullptr;
  png_infop info = nullptr;

  PngEncoding() = default;
  ~PngEncoding() { png_destroy_write_struct(&png, &info); }
  PngEncoding(const PngEncoding&) = delete;
  PngEncoding& operator=(const PngEncoding&) = delete;
};

[[noreturn]] void on_encoding_error(png_structp png, png_const_charp message) {
  auto& problem = static_cast<PngEncoding*>(png_get_error_ptr(png))->problem;
  std::string_view(message).substr(0, problem.size() - 1).copy(problem.data(), problem.size() - 1);
  png_longjmp(png, 1);
}

void on_encoding_warning(png_structp, png_const_charp) {}

void append_png_bytes(png_structp png, png_bytep bytes, std::size_t size) {
  bool fits = true;
  try {
    static_cast<PngEncoding*>(png_get_io_ptr(png))
        ->bytes.append(reinterpret_cast<const char*>(bytes), size);
  } catch (const std::bad_alloc&) {  // must not fly through C
    fits = false;
  }
  if (!fits) png_error(png, "out of memory");
}

void flush_nothing(png_structp) {}

struct PngKind {
  int bits, color_type;
};

/// False where libpng gave up; `problem` says why.
template <class Pixel>
bool write_png(PngEncoding& encoding, const Image<Pixel>& image, PngKind kind) {
  constexpr int kLevel = 3;
  encoding.png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &encoding, on_encoding_error,
                                         on_encoding_warning);
  if (encoding.png == nullptr) return false;
  encoding.info = png_create_info_struct(encoding.png);
  if (encoding.info == nullptr || setjmp(png_jmpbuf(encoding.png)) != 0) return false;
  png_set_write_fn(encoding.png, &encoding, append_png_bytes, flush_nothing);
  png_set_compression_level(encoding.png, kLevel);
  png_set_compression_strategy(encoding.png, Z_RLE);
  png_set_IHDR(encoding.png, encoding.info, static_cast<png_uint_32>(image.width()),
               static_cast<png_uint_32>(image.height()), kind.bits, kind.color_type,
               PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_write_info(encoding.png, encoding.info);
  // PNG has the higher byte first.
  if (kind.bits == 16 && std::endian::native == std::endian::little) png_set_swap(encoding.png);
  for (int y = 0; y < image.height(); ++y) {
    png_write_row(encoding.png, reinterpret_cast<png_const_bytep>(image.row(y)));
  }
  png_write_end(encoding.png, encoding.info);
  return true;
}

template <class Pixel>
Result<std::string> encode_png(const Image<Pixel>& image, PngKind kind) {
  SGS_CHECK(!image.empty(), "an empty image cannot be encoded");
  PngEncoding encoding;
  if (write_png(encoding, image, kind)) return std::move(encoding.bytes);
  return fail(ErrorCode::kIo, fmt::format("the image cannot be encoded as PNG: {}",
                                          encoding.png == nullptr || encoding.problem[0] == '\0'
                                              ? "out of memory"
                                              : encoding.problem.data()));
}

}  // namespace

Result<std::string> encode_png_color(const ColorImage& image) {
  static_assert(sizeof(Rgb8) == 3, "rows go to libpng as they are");
  return encode_png(image, {8, PNG_COLOR_TYPE_RGB});
}

Result<std::string> encode_png_grey8(const GrayImage& image) {
  return encode_png(image, {8, PNG_COLOR_TYPE_GRAY});
}

Result<std::string> encode_png_grey16(const Image<std::uint16_t>& image) {
  return encode_png(image, {16, PNG_COLOR_TYPE_GRAY});
}

}  // namespace sgs::io
