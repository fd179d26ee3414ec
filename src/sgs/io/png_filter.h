// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

namespace sgs::io {

/// Bytes behind the filtered rows of a PNG that must be readable: pixels are read as words.
inline constexpr std::size_t kPngRowPadding = 4;

/// Undoes the filters of a PNG's rows. `filtered` holds `rows` times the number of a filter and
/// `row_bytes` (> 0, whole pixels of `pixel_bytes`, 1 to 4), `out` gets the rows without the
/// number. False where there is no filter of that number. Source: PNG specification (W3C, 3rd
/// edition) section 9.
bool unfilter_png(const std::uint8_t* filtered, std::size_t rows, std::size_t row_bytes,
                  std::size_t pixel_bytes, std::uint8_t* out);

}  // namespace sgs::io
