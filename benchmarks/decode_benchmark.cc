// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// How long images take to be decoded, with ours and with what else Debian has: CPU time of one
// thread, median over all files. sgs_decode_benchmark FILES..., all of one kind.
#include <fmt/format.h>
#include <libdeflate.h>
#include <png.h>
#include <zlib.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <functional>
#include <string>
#include <vector>
// libjpeg's header needs cstdio's names before it.
#include <jpeglib.h>
#if defined(SGS_HAVE_SPNG)
#include <spng.h>
#endif
#if defined(SGS_HAVE_ISAL)
#include <isa-l.h>
#endif

#include "sgs/io/atomic_file.h"
#include "sgs/io/image_io.h"
#include "sgs/io/image_stream.h"

namespace {

using Bytes = std::vector<unsigned char>;
using Decode = std::function<bool(const std::string& file)>;

double cpu_ms() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

const unsigned char* data_of(const std::string& bytes) {
  return reinterpret_cast<const unsigned char*>(bytes.data());
}

/// Prints a row of the table.
void time_it(const char* what, const std::vector<std::string>& files, const Decode& decode) {
  constexpr int kRounds = 5;
  std::vector<double> times_ms;
  for (int round = 0; round < kRounds; ++round) {
    for (const std::string& file : files) {
      const double since_ms = cpu_ms();
      if (!decode(file)) {
        fmt::print("| {} | fails |\n", what);
        return;
      }
      times_ms.push_back(cpu_ms() - since_ms);
    }
  }
  std::sort(times_ms.begin(), times_ms.end());
  fmt::print("| {} | {:.2f} |\n", what, times_ms[times_ms.size() / 2]);
}

bool decode_libpng(const std::string& file, Bytes& out) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  if (png_image_begin_read_from_memory(&image, file.data(), file.size()) == 0) return false;
  out.resize(PNG_IMAGE_SIZE(image));
  return png_image_finish_read(&image, nullptr, out.data(), 0, nullptr) != 0;
}

#if defined(SGS_HAVE_SPNG)
bool decode_spng(const std::string& file, Bytes& out) {
  spng_ctx* context = spng_ctx_new(0);
  std::size_t size = 0;
  const bool well =
      spng_set_png_buffer(context, file.data(), file.size()) == 0 &&
      spng_decoded_image_size(context, SPNG_FMT_PNG, &size) == 0 &&
      (out.resize(size), spng_decode_image(context, out.data(), size, SPNG_FMT_PNG, 0) == 0);
  spng_ctx_free(context);
  return well;
}
#endif

bool decode_libjpeg(const std::string& file, J_COLOR_SPACE colors, unsigned denominator,
                    Bytes& out) {
  jpeg_decompress_struct jpeg{};
  jpeg_error_mgr errors{};
  jpeg.err = jpeg_std_error(&errors);
  jpeg_create_decompress(&jpeg);
  jpeg_mem_src(&jpeg, data_of(file), file.size());
  jpeg_read_header(&jpeg, TRUE);
  jpeg.out_color_space = colors;
  jpeg.scale_num = 1;
  jpeg.scale_denom = denominator;
  jpeg_start_decompress(&jpeg);
  const auto stride = static_cast<std::size_t>(jpeg.output_width) *
                      static_cast<std::size_t>(jpeg.output_components);
  out.resize(stride * jpeg.output_height);
  while (jpeg.output_scanline < jpeg.output_height) {
    JSAMPROW row = out.data() + stride * jpeg.output_scanline;
    jpeg_read_scanlines(&jpeg, &row, 1);
  }
  jpeg_finish_decompress(&jpeg);
  jpeg_destroy_decompress(&jpeg);
  return true;
}

/// The zlib stream in a PNG's IDAT chunks.
std::string idat(const std::string& png) {
  constexpr std::size_t kSignature = 8, kFrame = 12;
  std::string stream;
  for (std::size_t at = kSignature; at + kFrame <= png.size();) {
    std::size_t length = 0;
    for (std::size_t i = 0; i < 4; ++i) length = length << 8 | data_of(png)[at + i];
    if (png.compare(at + 4, 4, "IDAT") == 0) stream += png.substr(at + 8, length);
    at += kFrame + length;
  }
  return stream;
}

void inflate_rows(const std::vector<std::string>& files) {
  std::vector<std::string> streams;
  for (const std::string& file : files) streams.push_back(idat(file));
  constexpr std::size_t kLargest = std::size_t{64} << 20;
  Bytes out(kLargest);
  time_it("inflate only: zlib", streams, [&](const std::string& stream) {
    uLongf size = out.size();
    return uncompress(out.data(), &size, data_of(stream), stream.size()) == Z_OK;
  });
  time_it("inflate only: libdeflate", streams, [&](const std::string& stream) {
    libdeflate_decompressor* inflater = libdeflate_alloc_decompressor();
    std::size_t size = 0;
    const auto result = libdeflate_zlib_decompress(inflater, stream.data(), stream.size(),
                                                   out.data(), out.size(), &size);
    libdeflate_free_decompressor(inflater);
    return result == LIBDEFLATE_SUCCESS;
  });
#if defined(SGS_HAVE_ISAL)
  time_it("inflate only: ISA-L", streams, [&](const std::string& stream) {
    static inflate_state state;  // a hundred kilobytes
    isal_inflate_init(&state);
    state.crc_flag = ISAL_ZLIB;
    state.next_in = const_cast<unsigned char*>(data_of(stream));
    state.avail_in = static_cast<std::uint32_t>(stream.size());
    state.next_out = out.data();
    state.avail_out = static_cast<std::uint32_t>(out.size());
    return isal_inflate(&state) == ISAL_DECOMP_OK;
  });
#endif
}

void png_rows(const std::vector<std::string>& files, bool depth) {
  Bytes out;
  time_it("ours", files, [&](const std::string& file) {
    return depth ? sgs::io::decode_depth(file, "", 1000).has_value()
                 : sgs::io::decode_color(file, "").has_value();
  });
  time_it("libpng", files, [&](const std::string& file) { return decode_libpng(file, out); });
#if defined(SGS_HAVE_SPNG)
  time_it("libspng", files, [&](const std::string& file) { return decode_spng(file, out); });
#endif
  inflate_rows(files);
}

void jpeg_rows(const std::vector<std::string>& files) {
  Bytes out;
  time_it("ours", files,
          [](const std::string& file) { return sgs::io::decode_color(file, "").has_value(); });
  const auto libjpeg = [&](const char* what, J_COLOR_SPACE colors, unsigned denominator) {
    time_it(what, files, [&](const std::string& file) {
      return decode_libjpeg(file, colors, denominator, out);
    });
  };
  libjpeg("libjpeg-turbo", JCS_RGB, 1);
  libjpeg("libjpeg-turbo, grey", JCS_GRAYSCALE, 1);
  libjpeg("libjpeg-turbo, 1/2", JCS_RGB, 2);
  libjpeg("libjpeg-turbo, 1/4", JCS_RGB, 4);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("CPU time of decoding images");
  std::vector<std::string> paths;
  app.add_option("FILES", paths, "PNG or JPEG files of one kind")->required();
  CLI11_PARSE(app, argc, argv);
  std::vector<std::string> files;
  for (const std::string& path : paths) {
    auto bytes = sgs::io::read_file(path);
    if (!bytes || !sgs::io::check_image_stream(*bytes).problem.empty()) {
      fmt::print(stderr, "{}: not an image\n", path);
      return 1;
    }
    files.push_back(std::move(*bytes));
  }
  const auto kind = sgs::io::check_image_stream(files.front());
  fmt::print("{}x{}, {} bits, {} files like {}\n\n| | ms |\n|---|---|\n", kind.width, kind.height,
             kind.bits_per_channel, files.size(), paths.front());
  if (kind.kind == sgs::io::StreamCheck::Kind::kJpeg) {
    jpeg_rows(files);
  } else {
    png_rows(files, kind.bits_per_channel > 8);
  }
  return 0;
}
