// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "sgs/core/image.h"

namespace sgs::io {

// PNGs as recordings have them, several times faster than libpng: inflated at once by libdeflate.
// Empty for everything out of the ordinary: other kinds of pixels, palettes, interlaced images,
// unusual orders of chunks, and whatever is damaged. libpng then decodes it or says what is wrong.
// Checksums of chunks are the caller's to check before (check_image_stream).

/// A PNG of 8-bit RGB.
std::optional<ColorImage> decode_plain_png_color(std::string_view bytes);
/// A PNG of one channel with 16 bits.
std::optional<Image<std::uint16_t>> decode_plain_png_grey16(std::string_view bytes);

}  // namespace sgs::io
