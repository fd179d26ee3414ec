// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace sgs::io {

/// What the bytes of an image file say about themselves before any decoding.
struct StreamCheck {
  enum class Kind { kPng, kJpeg, kUnknown } kind = Kind::kUnknown;
  int bits_per_channel = 8;
  /// Empty when the stream runs from its signature to its end marker; otherwise what is wrong.
  std::string problem = {};
  int width = 0, height = 0;  ///< as announced; 0 where nothing was
  /// How a viewer turns a JPEG before it shows it: 1 = not at all, else 2 .. 8 (Exif 2.32, tag
  /// 0x0112).
  int orientation = 1;
};

/// Walks the chunks of a PNG (to IEND, with their checksums) or the segments of a JPEG (to EOI).
/// Image decoders hand out what they have of a truncated stream, grey rows for the rest; this tells
/// it from a whole one. Sources: PNG specification (W3C, 3rd edition) section 5; ITU-T T.81 annex
/// B.
StreamCheck check_image_stream(std::string_view bytes);

}  // namespace sgs::io
