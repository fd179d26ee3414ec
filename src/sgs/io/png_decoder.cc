// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <png.h>

#include <algorithm>
#include <array>
#include <bit>
#include <csetjmp>
#include <cstring>
#include <string_view>
#include <vector>

#include "sgs/io/image_decoder.h"
#include "sgs/io/plain_png.h"

namespace sgs::io {
namespace {

/// What libpng's callbacks see. libpng leaves its functions by longjmp: everything that owns memory
/// lives here, outside of the functions that are left.
struct PngDecoding {
  std::string_view rest;  ///< of the file, not read yet
  std::array<char, 100> problem{};
  std::vector<png_bytep> rows;
  png_structp png = nullptr;
  png_infop info = nullptr;

  PngDecoding() = default;
  ~PngDecoding() { png_destroy_read_struct(&png, &info, nullptr); }
  PngDecoding(const PngDecoding&) = delete;
  PngDecoding& operator=(const PngDecoding&) = delete;
};

[[noreturn]] void on_png_error(png_structp png, png_const_charp message) {
  auto& problem = static_cast<PngDecoding*>(png_get_error_ptr(png))->problem;
  std::string_view(message).substr(0, problem.size() - 1).copy(problem.data(), problem.size() - 1);
  png_longjmp(png, 1);
}

void on_png_warning(png_structp, png_const_charp) {}

void read_png_bytes(png_structp png, png_bytep out, std::size_t size) {
  auto& rest = static_cast<PngDecoding*>(png_get_io_ptr(png))->rest;
  if (size > rest.size()) png_error(png, "it ends too early");
  std::memcpy(out, rest.data(), size);
  rest.remove_prefix(size);
}

/// False where libpng gave up; `problem` says why.
bool open_png(PngDecoding& decoding, std::string_view bytes) {
  decoding.rest = bytes;
  decoding.png =
      png_create_read_struct(PNG_LIBPNG_VER_STRING, &decoding, on_png_error, on_png_warning);
  if (decoding.png == nullptr) return false;
  decoding.info = png_create_info_struct(decoding.png);
  if (decoding.info == nullptr || setjmp(png_jmpbuf(decoding.png)) != 0) return false;
  png_set_read_fn(decoding.png, &decoding, read_png_bytes);
  // Texts and profiles are not wanted, and each could announce megabytes.
  png_set_keep_unknown_chunks(decoding.png, PNG_HANDLE_CHUNK_NEVER, nullptr, 0);
  png_read_info(decoding.png, decoding.info);
  return true;
}

/// Asks libpng to make three channels of eight bits of whatever is stored.
bool expand_to_color(PngDecoding& decoding) {
  if (setjmp(png_jmpbuf(decoding.png)) != 0) return false;
  const int type = png_get_color_type(decoding.png, decoding.info);
  png_set_strip_16(decoding.png);
  png_set_strip_alpha(decoding.png);
  if (type == PNG_COLOR_TYPE_PALETTE) png_set_palette_to_rgb(decoding.png);
  if ((type & PNG_COLOR_MASK_COLOR) == 0) {
    if (png_get_bit_depth(decoding.png, decoding.info) < 8) {
      png_set_expand_gray_1_2_4_to_8(decoding.png);
    }
    png_set_gray_to_rgb(decoding.png);
  }
  return true;
}

/// Reads all rows, which hold `bytes_per_row` each, and what follows them.
bool read_rows(PngDecoding& decoding, std::size_t bytes_per_row) {
  if (setjmp(png_jmpbuf(decoding.png)) != 0) return false;
  png_set_interlace_handling(decoding.png);
  png_read_update_info(decoding.png, decoding.info);
  if (png_get_rowbytes(decoding.png, decoding.info) != bytes_per_row) {
    png_error(decoding.png, "an unexpected layout of pixels");
  }
  png_read_image(decoding.png, decoding.rows.data());
  png_read_end(decoding.png, nullptr);
  return true;
}

tl::unexpected<Error> damaged_png(const PngDecoding& decoding) {
  return fail(ErrorCode::kInvalidFormat,
              fmt::format("damaged PNG: {}",
                          decoding.problem[0] == 0 ? "no memory" : decoding.problem.data()),
              "copy or record the image again");
}

/// The pixels of an opened PNG, in the form that was asked for.
template <class Pixel>
Result<Image<Pixel>> read_pixels(PngDecoding& decoding) {
  Image<Pixel> image(static_cast<int>(png_get_image_width(decoding.png, decoding.info)),
                     static_cast<int>(png_get_image_height(decoding.png, decoding.info)));
  for (int y = 0; y < image.height(); ++y) {
    decoding.rows.push_back(reinterpret_cast<png_bytep>(image.row(y)));
  }
  const std::size_t bytes_per_row = sizeof(Pixel) * static_cast<std::size_t>(image.width());
  if (!read_rows(decoding, bytes_per_row)) return damaged_png(decoding);
  return image;
}

}  // namespace

Result<ColorImage> decode_png_color(std::string_view bytes) {
  static_assert(sizeof(Rgb8) == 3);
  if (auto image = decode_plain_png_color(bytes)) return std::move(*image);
  PngDecoding decoding;
  if (!open_png(decoding, bytes) || !expand_to_color(decoding)) return damaged_png(decoding);
  return read_pixels<Rgb8>(decoding);
}

Result<Image<std::uint16_t>> decode_png_grey16(std::string_view bytes) {
  if (auto image = decode_plain_png_grey16(bytes)) return std::move(*image);
  PngDecoding decoding;
  if (!open_png(decoding, bytes)) return damaged_png(decoding);
  const int channels = png_get_channels(decoding.png, decoding.info);
  if (channels != 1 || png_get_bit_depth(decoding.png, decoding.info) != 16) {
    return fail(ErrorCode::kUnsupported,
                fmt::format("{} channels where single-channel depth is needed", channels),
                "export raw depth as single-channel 16-bit PNG");
  }
  if constexpr (std::endian::native == std::endian::little) png_set_swap(decoding.png);
  return read_pixels<std::uint16_t>(decoding);
}

}  // namespace sgs::io
