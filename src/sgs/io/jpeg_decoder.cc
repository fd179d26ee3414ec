// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <csetjmp>
#include <cstddef>
#include <cstdio>
// libjpeg's headers need those before them.
#include <jerror.h>
#include <jpeglib.h>

#include "sgs/io/image_decoder.h"

namespace sgs::io {
namespace {

/// What libjpeg's callbacks see. They leave its functions by longjmp: everything that owns memory
/// lives here or with the caller.
struct JpegDecoding {
  jpeg_decompress_struct jpeg{};
  jpeg_error_mgr errors{};
  std::jmp_buf give_up{};
  std::array<char, JMSG_LENGTH_MAX> problem{};
  bool created = false;

  JpegDecoding() = default;
  ~JpegDecoding() {
    if (created) jpeg_destroy_decompress(&jpeg);
  }
  JpegDecoding(const JpegDecoding&) = delete;
  JpegDecoding& operator=(const JpegDecoding&) = delete;
};

[[noreturn]] void on_jpeg_error(j_common_ptr jpeg) {
  auto& decoding = *static_cast<JpegDecoding*>(jpeg->client_data);
  jpeg->err->format_message(jpeg, decoding.problem.data());
  std::longjmp(decoding.give_up, 1);
}

/// Warnings have level -1. libjpeg goes on with whatever pixels are left; we do not.
void on_jpeg_message(j_common_ptr jpeg, int level) {
  if (level >= 0) return;
  switch (jpeg->err->msg_code) {
    case JWRN_EXTRANEOUS_DATA:
    case JWRN_TOO_MUCH_DATA:
    case JWRN_JFIF_MAJOR:
    case JWRN_ADOBE_XFORM:
      return;  // bytes between segments, odd versions: the pixels are all there
    default:
      on_jpeg_error(jpeg);
  }
}

void print_nothing(j_common_ptr) {}

/// False where libjpeg gave up; `problem` says why.
bool open_jpeg(JpegDecoding& decoding, std::string_view bytes) {
  auto& jpeg = decoding.jpeg;
  jpeg.err = jpeg_std_error(&decoding.errors);
  jpeg.err->error_exit = on_jpeg_error;
  jpeg.err->emit_message = on_jpeg_message;
  jpeg.err->output_message = print_nothing;
  jpeg.client_data = &decoding;
  if (setjmp(decoding.give_up) != 0) return false;
  jpeg_create_decompress(&jpeg);
  decoding.created = true;
  jpeg_mem_src(&jpeg, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
  jpeg_read_header(&jpeg, TRUE);
  return true;
}

bool read_jpeg_rows(JpegDecoding& decoding, ColorImage& image) {
  auto& jpeg = decoding.jpeg;
  if (setjmp(decoding.give_up) != 0) return false;
  jpeg.out_color_space = JCS_RGB;
  jpeg_start_decompress(&jpeg);
  while (jpeg.output_scanline < jpeg.output_height) {
    auto* row = reinterpret_cast<JSAMPROW>(image.row(static_cast<int>(jpeg.output_scanline)));
    jpeg_read_scanlines(&jpeg, &row, 1);
  }
  jpeg_finish_decompress(&jpeg);
  return true;
}

tl::unexpected<Error> damaged_jpeg(const JpegDecoding& decoding) {
  return fail(ErrorCode::kInvalidFormat, fmt::format("damaged JPEG: {}", decoding.problem.data()),
              "copy or record the image again");
}

}  // namespace

Result<ColorImage> decode_jpeg(std::string_view bytes) {
  JpegDecoding decoding;
  if (!open_jpeg(decoding, bytes)) return damaged_jpeg(decoding);
  if (decoding.jpeg.num_components == 4) {
    return fail(ErrorCode::kUnsupported, "a CMYK picture", "convert it to RGB");
  }
  ColorImage image(static_cast<int>(decoding.jpeg.image_width),
                   static_cast<int>(decoding.jpeg.image_height));
  if (!read_jpeg_rows(decoding, image)) return damaged_jpeg(decoding);
  return image;
}

}  // namespace sgs::io
