// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/io/png_filter.h"

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

#include <algorithm>
#include <cstring>
#include <vector>

#include "sgs/core/error.h"

namespace sgs::io {
namespace {

// Each byte of a pixel depends on the same byte of the pixel before it, so a vector is a pixel in
// its lower half, or two of neighbouring rows. Lanes beyond a pixel hold whatever follows; they are
// overwritten by the next pixel. GCC's vectors, not Highway's: its smallest set for x86-64 is more
// than every machine has, so that a scalar copy would be needed as well.
using Words = std::int16_t __attribute__((vector_size(16)));
constexpr std::size_t kHalf = 4;  ///< lanes of a pixel
static_assert(kPngRowPadding >= kHalf);

Words load(const std::uint8_t* pixel) {
#if defined(__SSE2__)
  int bytes = 0;
  std::memcpy(&bytes, pixel, kHalf);
  return Words(_mm_unpacklo_epi8(_mm_cvtsi32_si128(bytes), _mm_setzero_si128()));
#else
  return Words{pixel[0], pixel[1], pixel[2], pixel[3]};
#endif
}

/// Stores the first `kCount` lanes, which are bytes.
template <std::size_t kCount = kHalf>
void store(Words pixel, std::uint8_t* out) {
#if defined(__SSE2__)
  const int bytes = _mm_cvtsi128_si32(_mm_packus_epi16(__m128i(pixel), __m128i(pixel)));
  std::memcpy(out, &bytes, kCount);
#else
  for (std::size_t i = 0; i < kCount; ++i) out[i] = static_cast<std::uint8_t>(pixel[i]);
#endif
}

/// The lower halves of both, one above the other.
Words joined(Words low, Words high) {
  return __builtin_shufflevector(low, high, 0, 1, 2, 3, 8, 9, 10, 11);
}
Words upper_half(Words both) { return __builtin_shufflevector(both, both, 4, 5, 6, 7, 4, 5, 6, 7); }

Words low_bytes(Words sum) { return sum & std::int16_t{0xFF}; }

Words magnitude(Words x) {
  const Words sign = x >> 15;  // GCC 12 takes "x < 0 ? -x : x" apart
  return (x ^ sign) - sign;
}

Words smaller(Words a, Words b) { return a < b ? a : b; }

/// Whichever of the left, upper and upper left byte is nearest to left + upper - upper left.
Words paeth_predictor(Words left, Words up, Words up_left) {
  const Words from_left = up - up_left, from_up = left - up_left;
  const Words to_up_left = magnitude(from_left + from_up);
  const Words to_left = magnitude(from_left), to_up = magnitude(from_up);
  const Words nearest = smaller(to_up_left, smaller(to_left, to_up));
  return nearest == to_left ? left : nearest == to_up ? up : up_left;
}

/// Calls undo(filtered, left, up, up_left) -> pixel for each pixel of a row.
template <std::size_t kPixelBytes, class Undo>
void for_each_pixel(const std::uint8_t* in, const std::uint8_t* prior, std::uint8_t* out,
                    std::size_t row_bytes, const Undo& undo) {
  const std::size_t last = row_bytes - kPixelBytes;
  Words left{}, up_left{};
  for (std::size_t i = 0; i < last; i += kPixelBytes) {
    const Words up = load(prior + i);
    left = undo(load(in + i), left, up, up_left);
    up_left = up;
    store(left, out + i);
  }
  store<kPixelBytes>(undo(load(in + last), left, load(prior + last), up_left), out + last);
}

/// Undoes Paeth's filter of two rows at once, the second one a pixel behind the first: the filter
/// is one long chain of small steps, and two chains take little longer than one.
template <std::size_t kPixelBytes>
void undo_paeth_pair(const std::uint8_t* in, const std::uint8_t* prior, std::uint8_t* out,
                     std::size_t row_bytes) {
  const std::uint8_t* in_below = in + row_bytes + 1;
  std::uint8_t* below = out + row_bytes;
  const std::size_t last = row_bytes - kPixelBytes;
  const auto undo = [](Words x, Words left, Words up, Words up_left) {
    return low_bytes(x + paeth_predictor(left, up, up_left));
  };
  const Words first_up = load(prior);
  const Words first = undo(load(in), Words{}, first_up, Words{});
  store<kPixelBytes>(first, out);
  Words left = joined(first, Words{}), up_left = joined(first_up, Words{});
  // The first row's pixel at i and the second one's before it.
  const auto step = [&](std::size_t i) {
    const Words up = joined(load(prior + i), left);
    const Words x = joined(load(in + i), load(in_below + i - kPixelBytes));
    left = undo(x, left, up, up_left);
    up_left = up;
  };
  for (std::size_t i = kPixelBytes; i < last; i += kPixelBytes) {
    step(i);
    store(left, out + i);
    store(upper_half(left), below + i - kPixelBytes);
  }
  if (last > 0) {
    step(last);
    // Nothing is spilled here: the second row's first pixel comes next, and is there already.
    store<kPixelBytes>(left, out + last);
    store<kPixelBytes>(upper_half(left), below + last - kPixelBytes);
  }
  store<kPixelBytes>(undo(load(in_below + last), upper_half(left), left, upper_half(up_left)),
                     below + last);
}

enum PngFilter : std::uint8_t { kNone, kSub, kUp, kAverage, kPaeth };

template <std::size_t kPixelBytes>
bool undo_filter(std::uint8_t filter, const std::uint8_t* in, const std::uint8_t* prior,
                 std::uint8_t* out, std::size_t row_bytes) {
  const auto pixels = [&](const auto& undo) {
    for_each_pixel<kPixelBytes>(in, prior, out, row_bytes, undo);
    return true;
  };
  switch (filter) {
    case kNone:
      std::copy_n(in, row_bytes, out);
      return true;
    case kSub:
      return pixels([](Words x, Words left, Words, Words) { return low_bytes(x + left); });
    case kUp:
      for (std::size_t i = 0; i < row_bytes; ++i) {
        out[i] = static_cast<std::uint8_t>(in[i] + prior[i]);
      }
      return true;
    case kAverage:
      return pixels(
          [](Words x, Words left, Words up, Words) { return low_bytes(x + ((left + up) >> 1)); });
    case kPaeth:
      return pixels([](Words x, Words left, Words up, Words up_left) {
        return low_bytes(x + paeth_predictor(left, up, up_left));
      });
    default:
      return false;
  }
}

template <std::size_t kPixelBytes>
bool unfilter_rows(const std::uint8_t* in, std::size_t rows, std::size_t row_bytes,
                   std::uint8_t* out) {
  const std::vector<std::uint8_t> black(row_bytes + kPngRowPadding);
  const std::uint8_t* prior = black.data();
  const std::size_t stride = row_bytes + 1;
  for (std::size_t y = 0; y < rows;) {
    const bool pair = y + 1 < rows && in[0] == kPaeth && in[stride] == kPaeth;
    if (pair) {
      undo_paeth_pair<kPixelBytes>(in + 1, prior, out, row_bytes);
    } else if (!undo_filter<kPixelBytes>(in[0], in + 1, prior, out, row_bytes)) {
      return false;
    }
    const std::size_t done = pair ? 2 : 1;
    y += done;
    in += done * stride;
    out += done * row_bytes;
    prior = out - row_bytes;
  }
  return true;
}

}  // namespace

bool unfilter_png(const std::uint8_t* filtered, std::size_t rows, std::size_t row_bytes,
                  std::size_t pixel_bytes, std::uint8_t* out) {
  SGS_CHECK(pixel_bytes >= 1 && pixel_bytes <= 4 && row_bytes % pixel_bytes == 0 && row_bytes > 0,
            "a row must be whole pixels of 1 to 4 bytes");
  constexpr decltype(&unfilter_rows<1>) kUnfilter[] = {unfilter_rows<1>, unfilter_rows<2>,
                                                       unfilter_rows<3>, unfilter_rows<4>};
  return kUnfilter[pixel_bytes - 1](filtered, rows, row_bytes, out);
}

}  // namespace sgs::io
