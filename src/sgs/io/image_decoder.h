// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>

#include "sgs/core/error.h"
#include "sgs/core/image.h"

namespace sgs::io {

// Decoders over libpng and libjpeg that say nothing on the terminal and take damage as damage: what
// the libraries only warn about (pixels that are missing, codes that do not exist) is an error,
// what they can do without (a wrong colour profile) is not. Sizes are the caller's to check before
// (check_image_stream). The messages name no file.

/// Any 8-bit PNG as colour: palettes and grey are expanded, alpha is dropped.
Result<ColorImage> decode_png_color(std::string_view bytes);
/// A PNG of one channel with 16 bits.
Result<Image<std::uint16_t>> decode_png_grey16(std::string_view bytes);
/// Grey and YCbCr JPEG as colour; CMYK is refused.
Result<ColorImage> decode_jpeg(std::string_view bytes);

}  // namespace sgs::io
