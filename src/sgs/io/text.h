// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>
#include <vector>

namespace sgs::io {

/// One line of a text file that holds something.
struct TextLine {
  int number = 0;         ///< 1 = first line of the file
  std::string_view text;  ///< without comment, leading and trailing white space; never empty
};

/// The lines of `content` that are not blank, '#' comments cut off. Views into `content`.
std::vector<TextLine> content_lines(std::string_view content);

/// Splits at runs of white space and characters of `separators`.
std::vector<std::string_view> split_fields(std::string_view text, std::string_view separators = "");

/// A number in any usual spelling ("1", "-2.5e3", "+1", "nan"); empty if anything else is there.
std::optional<double> parse_double(std::string_view text);

/// All numbers of a text, '#' comments cut off; empty if anything else is there or one is not
/// finite.
std::optional<std::vector<double>> parse_doubles(std::string_view content,
                                                 std::string_view separators = "");

}  // namespace sgs::io
