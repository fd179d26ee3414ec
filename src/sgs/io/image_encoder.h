// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "sgs/core/error.h"
#include "sgs/core/image.h"

namespace sgs::io {

// Encoders over libpng and libjpeg. Images must not be empty. Too large a picture or a lack of
// memory is an error; nothing is printed.

/// The bytes of a PNG file, deflated for speed rather than size.
Result<std::string> encode_png_color(const ColorImage& image);
/// The same of one channel with 8 bits.
Result<std::string> encode_png_grey8(const GrayImage& image);
/// The same of one channel with 16 bits.
Result<std::string> encode_png_grey16(const Image<std::uint16_t>& image);
/// The bytes of a JPEG file (4:2:0); `quality` 1..100.
Result<std::string> encode_jpeg_color(const ColorImage& image, int quality);

}  // namespace sgs::io
