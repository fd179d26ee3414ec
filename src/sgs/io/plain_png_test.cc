// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/io/plain_png.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <cstdlib>
#include <random>
#include <string>

#include "sgs/io/image_decoder.h"

namespace sgs::io {
namespace {

std::string big_endian32(std::size_t value) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift);
  return bytes;
}

std::string chunk(const std::string& type, const std::string& data) {
  const std::string body = type + data;
  const auto sum =
      crc32(0, reinterpret_cast<const Bytef*>(body.data()), static_cast<uInt>(body.size()));
  return big_endian32(data.size()) + body + big_endian32(sum);
}

std::string deflated(const std::string& bytes) {
  uLongf size = compressBound(bytes.size());
  std::string out(size, '\0');
  compress(reinterpret_cast<Bytef*>(out.data()), &size,
           reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
  out.resize(size);
  return out;
}

/// A PNG in its parts, to be put together rightly or wrongly.
struct Parts {
  std::size_t width = 0, height = 0;
  char bits = 8, color_type = 2, interlaced = 0;
  std::string rows = {};  ///< filtered, each with the number of its filter

  std::string header() const {
    return chunk("IHDR", big_endian32(width) + big_endian32(height) +
                             std::string{bits, color_type, 0, 0, interlaced});
  }
  /// With `between` before each IDAT of at most `idat_bytes`.
  std::string file(const std::string& between = "", std::size_t idat_bytes = 1 << 20) const {
    std::string bytes = "\x89PNG\r\n\x1a\n" + header();
    const std::string all = deflated(rows);
    for (std::size_t at = 0; at < all.size(); at += idat_bytes) {
      bytes += between + chunk("IDAT", all.substr(at, idat_bytes));
    }
    return bytes + chunk("IEND", "");
  }
};

int paeth(int left, int up, int up_left) {
  const int p = left + up - up_left;
  const int a = std::abs(p - left), b = std::abs(p - up), c = std::abs(p - up_left);
  return a <= b && a <= c ? left : b <= c ? up : up_left;
}

/// Filters the bytes of an image as the PNG specification's section 9 says, the filter of row y
/// being filters[y].
Parts filtered(const std::string& pixels, std::size_t width, std::size_t pixel_bytes,
               const std::string& filters) {
  Parts parts{width, filters.size()};
  const std::size_t row_bytes = width * pixel_bytes;
  const auto at = [&](std::size_t y, std::size_t i, std::size_t up, std::size_t left) {
    return y < up || i < left ? 0
                              : static_cast<std::uint8_t>(pixels[(y - up) * row_bytes + i - left]);
  };
  for (std::size_t y = 0; y < filters.size(); ++y) {
    parts.rows += filters[y];
    for (std::size_t i = 0; i < row_bytes; ++i) {
      const int left = at(y, i, 0, pixel_bytes), up = at(y, i, 1, 0);
      const int guess[] = {0, left, up, (left + up) / 2, paeth(left, up, at(y, i, 1, pixel_bytes))};
      parts.rows += static_cast<char>(at(y, i, 0, 0) - guess[static_cast<int>(filters[y])]);
    }
  }
  return parts;
}

std::string random_bytes(std::size_t count, int below, unsigned seed) {
  std::mt19937 random(seed);
  std::string bytes(count, '\0');
  for (char& byte : bytes) byte = static_cast<char>(random() % static_cast<unsigned>(below));
  return bytes;
}

Parts small_picture() { return filtered(random_bytes(5 * 4 * 3, 256, 1), 5, 3, {4, 4, 1, 3}); }

TEST(PlainPng, EveryFilterIsUndoneForEveryWidth) {
  for (std::size_t width : {1, 2, 3, 4, 17, 64}) {
    for (unsigned seed = 1; seed <= 20; ++seed) {
      constexpr std::size_t kRows = 12;
      const std::string filters = random_bytes(kRows, 5, seed);
      const std::string pixels = random_bytes(width * 3 * kRows, 256, seed + 100);
      const auto color = decode_plain_png_color(filtered(pixels, width, 3, filters).file("", 50));
      ASSERT_TRUE(color);
      ASSERT_EQ(color->size(), width * kRows);
      EXPECT_EQ(std::string(reinterpret_cast<const char*>(color->data()), pixels.size()), pixels);

      Parts grey = filtered(pixels.substr(0, width * 2 * kRows), width, 2, filters);
      grey.bits = 16;
      grey.color_type = 0;
      const auto depth = decode_plain_png_grey16(grey.file());
      ASSERT_TRUE(depth);
      for (std::size_t i = 0; i < depth->size(); ++i) {
        const auto high = static_cast<std::uint8_t>(pixels[2 * i]);
        const auto low = static_cast<std::uint8_t>(pixels[2 * i + 1]);
        ASSERT_EQ(depth->data()[i], high << 8 | low) << width << " " << i;
      }
    }
  }
}

TEST(PlainPng, ChunksThatCanBePassedOverArePassedOver) {
  const std::string file = small_picture().file(chunk("tEXt", "Title"));
  EXPECT_TRUE(decode_plain_png_color(file));
}

// What is not plain is libpng's to decode.
TEST(PlainPng, OtherKindsAreLeftToLibpng) {
  Parts dot = filtered("abc", 1, 3, {0});
  dot.interlaced = 1;
  Parts deep = filtered(random_bytes(6, 256, 1), 1, 6, {0});
  deep.bits = 16;
  Parts alpha = filtered(random_bytes(4, 256, 1), 1, 4, {0});
  alpha.color_type = 6;
  Parts grey_alpha = filtered(random_bytes(2, 256, 1), 1, 2, {0});
  grey_alpha.color_type = 4;
  Parts grey = filtered("a", 1, 1, {0});
  grey.color_type = 0;
  for (const Parts& other : {dot, deep, alpha, grey_alpha, grey}) {
    EXPECT_FALSE(decode_plain_png_color(other.file()));
    EXPECT_TRUE(decode_png_color(other.file())) << int{other.color_type};
  }
  Parts palette = filtered(std::string(1, '\0'), 1, 1, {0});
  palette.color_type = 3;
  const auto indexed = decode_png_color(palette.file(chunk("PLTE", "xyz")));
  ASSERT_TRUE(indexed) << indexed.error().text();
  EXPECT_EQ((*indexed)(0, 0), (Rgb8{'x', 'y', 'z'}));
}

TEST(PlainPng, DamageIsNoPicture) {
  const Parts good = small_picture();
  ASSERT_TRUE(decode_plain_png_color(good.file()));
  EXPECT_FALSE(decode_plain_png_color(""));
  for (std::size_t length = 0; length < good.file().size(); ++length) {
    EXPECT_FALSE(decode_plain_png_color(good.file().substr(0, length))) << length;
  }
  Parts unknown_filter = good, short_rows = good, long_rows = good, huge = good;
  unknown_filter.rows[0] = 5;
  short_rows.rows.pop_back();
  long_rows.rows += 'x';
  huge.width = 999'999;  // nothing is allocated on its word
  huge.height = 999'999;
  for (const Parts& damaged : {unknown_filter, short_rows, huge}) {
    EXPECT_FALSE(decode_plain_png_color(damaged.file()));
  }
  EXPECT_FALSE(decode_plain_png_color(long_rows.file()));
  const std::string critical = good.file(chunk("ABCD", ""));
  EXPECT_FALSE(decode_plain_png_color(critical));
  const std::string no_letters = good.file(chunk("ab*D", ""));
  EXPECT_FALSE(decode_plain_png_color(no_letters));
  const std::string between_idats = good.file(chunk("tEXt", ""), 20);
  EXPECT_FALSE(decode_plain_png_color(between_idats));
  std::string wrong_sum = deflated(good.rows);
  wrong_sum.back() = static_cast<char>(wrong_sum.back() ^ 1);
  EXPECT_FALSE(decode_plain_png_color("\x89PNG\r\n\x1a\n" + good.header() +
                                      chunk("IDAT", wrong_sum) + chunk("IEND", "")));
}

}  // namespace
}  // namespace sgs::io
