// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// PNG and JPEG. The checksums of PNG chunks are put right first: mutated bytes would not get past
// them. Large sizes are left to a test; they are refused by the header.
#include <zlib.h>

#include "harness.h"
#include "sgs/io/image_decoder.h"
#include "sgs/io/image_io.h"
#include "sgs/io/image_stream.h"

namespace {

std::uint32_t number_at(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<std::uint8_t>(bytes[at + i]);
  return value;
}

void repair_checksums(std::string& png) {
  constexpr std::size_t kSignature = 8, kFrame = 12;
  for (std::size_t at = kSignature; at + kFrame <= png.size();) {
    const std::size_t length = number_at(png, at);
    if (length > png.size() - at - kFrame) return;
    const auto crc = ::crc32(0, reinterpret_cast<const Bytef*>(png.data() + at + 4),
                             static_cast<uInt>(length + 4));
    for (std::size_t i = 0; i < 4; ++i) {
      png[at + 8 + length + i] = static_cast<char>(crc >> (24 - 8 * i));
    }
    at += kFrame + length;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sgs;
  std::string bytes(reinterpret_cast<const char*>(data), size);
  if (bytes.starts_with("\x89PNG")) repair_checksums(bytes);
  const auto check = io::check_image_stream(bytes);
  constexpr int kLargestSide = 512;
  if (check.width > kLargestSide || check.height > kLargestSide) return 0;
  const fuzz::MemoryFile file(bytes);
  if (const auto image = io::load_color(file.path())) {
    fuzz::require(image->width() == check.width && image->height() == check.height,
                  "an image has the size that its header says");
  }
  if (const auto depth = io::load_depth(file.path(), 1000)) {
    for (std::size_t i = 0; i < depth->size(); ++i) {
      fuzz::require(depth->data()[i] >= 0 && depth->data()[i] < 66, "depth is in range");
    }
  }
  // The decoders must stand on their own, too.
  (void)io::decode_jpeg(bytes);
  (void)io::decode_png_color(bytes);
  (void)io::decode_png_grey16(bytes);
  return 0;
}
