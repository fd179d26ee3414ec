// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <csetjmp>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
// libjpeg's header needs those before it.
#include <jpeglib.h>

#include "sgs/io/image_encoder.h"

namespace sgs::io {
namespace {

/// What libjpeg's callbacks see. They leave its functions by longjmp: everything that owns memory
/// lives here or with the caller.
struct JpegEncoding {
  jpeg_compress_struct jpeg{};
  jpeg_error_mgr errors{};
  std::jmp_buf give_up{};
  std::array<char, JMSG_LENGTH_MAX> problem{};
  unsigned char* bytes = nullptr;  // of libjpeg's allocation
  unsigned long size = 0;
  bool created = false;

  JpegEncoding() = default;
  ~JpegEncoding() {
    if (created) jpeg_destroy_compress(&jpeg);
    std::free(bytes);
  }
  JpegEncoding(const JpegEncoding&) = delete;
  JpegEncoding& operator=(const JpegEncoding&) = delete;
};

[[noreturn]] void on_jpeg_encoding_error(j_common_ptr jpeg) {
  auto& encoding = *static_cast<JpegEncoding*>(jpeg->client_data);
  jpeg->err->format_message(jpeg, encoding.problem.data());
  std::longjmp(encoding.give_up, 1);
}

void say_nothing(j_common_ptr) {}

/// False where libjpeg gave up; `problem` says why.
bool write_jpeg(JpegEncoding& encoding, const ColorImage& image, int quality) {
  auto& jpeg = encoding.jpeg;
  jpeg.err = jpeg_std_error(&encoding.errors);
  jpeg.err->error_exit = on_jpeg_encoding_error;
  jpeg.err->output_message = say_nothing;
  jpeg.client_data = &encoding;
  if (setjmp(encoding.give_up) != 0) return false;
  jpeg_create_compress(&jpeg);
  encoding.created = true;
  jpeg_mem_dest(&jpeg, &encoding.bytes, &encoding.size);
  jpeg.image_width = static_cast<JDIMENSION>(image.width());
  jpeg.image_height = static_cast<JDIMENSION>(image.height());
  jpeg.input_components = 3;
  jpeg.in_color_space = JCS_RGB;
  jpeg_set_defaults(&jpeg);
  jpeg_set_quality(&jpeg, quality, TRUE);
  jpeg_start_compress(&jpeg, TRUE);
  while (jpeg.next_scanline < jpeg.image_height) {
    // libjpeg reads rows only, but its types say otherwise.
    auto* row = reinterpret_cast<JSAMPROW>(
        const_cast<Rgb8*>(image.row(static_cast<int>(jpeg.next_scanline))));
    jpeg_write_scanlines(&jpeg, &row, 1);
  }
  jpeg_finish_compress(&jpeg);
  return true;
}

}  // namespace

Result<std::string> encode_jpeg_color(const ColorImage& image, int quality) {
  SGS_CHECK(!image.empty(), "an empty image cannot be encoded");
  SGS_CHECK(quality >= 1 && quality <= 100, "JPEG quality must be 1..100");
  JpegEncoding encoding;
  if (!write_jpeg(encoding, image, quality)) {
    return fail(ErrorCode::kIo,
                fmt::format("the image cannot be encoded as JPEG: {}", encoding.problem.data()));
  }
  return std::string(reinterpret_cast<const char*>(encoding.bytes), encoding.size);
}

}  // namespace sgs::io
