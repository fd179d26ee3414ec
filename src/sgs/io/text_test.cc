// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/io/text.h"

#include <gtest/gtest.h>

namespace sgs::io {
namespace {

TEST(Text, Utf16WithAMarkBecomesUtf8) {
  using namespace std::string_literals;
  EXPECT_EQ(utf8_text("\xFF\xFE"s + "1\0 \0\xE4\0"s), "1 \xC3\xA4");
  EXPECT_EQ(utf8_text("\xFE\xFF"s + "\0"
                                    "1\0 \x20\xAC"s),
            "1 \xE2\x82\xAC");
  // A pair of surrogates, and half of one.
  EXPECT_EQ(utf8_text("\xFF\xFE\x3D\xD8\x00\xDE"s), "\xF0\x9F\x98\x80");
  EXPECT_EQ(utf8_text("\xFF\xFE\x3D\xD8"s), "\xEF\xBF\xBD");
  EXPECT_EQ(utf8_text("plain"), "plain");
}

TEST(Text, DecimalCommasAreReadWhereTheySeparateNothing) {
  EXPECT_EQ(parse_decimal("1305031098,6659"), 1305031098.6659);
  EXPECT_EQ(parse_decimal("1.5"), 1.5);
  EXPECT_FALSE(parse_decimal("1,2,3"));
  EXPECT_EQ(split_row("1,5 2,5 3", 3).at(0), "1,5");
  EXPECT_EQ(split_row("1,5;2,5;3", 3).at(1), "2,5");
  EXPECT_EQ(split_row("1.5,2.5,3", 3).at(1), "2.5");
  EXPECT_EQ(split_row("1.5, 2.5, 3", 3).at(1), "2.5");
}

}  // namespace
}  // namespace sgs::io
