// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sgs/core/error.h"
#include "sgs/io/atomic_file.h"

namespace sgs::io {

/// The content of a text file as UTF-8 with line feeds. What other systems write is converted:
/// UTF-16 (PowerShell's ">" writes it), carriage returns alone.
Result<std::string> read_text(const std::filesystem::path& path,
                              std::int64_t limit_bytes = kLargestFile_bytes);
/// The same of text in memory.
std::string utf8_text(std::string content);

/// Latin letters in their small form; other bytes as they are.
std::string lower_case(std::string text);

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

/// As parse_double(), or with a decimal comma instead of a point: programs write what the locale of
/// their user says.
std::optional<double> parse_decimal(std::string_view text);

/// The fields of a row that should have `count` of them: separated by white space or semicolons,
/// and then commas are decimal ones; else by white space, commas and semicolons.
std::vector<std::string_view> split_row(std::string_view text, std::size_t count);

/// All numbers of a text, '#' comments cut off; empty if anything else is there or one is not
/// finite.
std::optional<std::vector<double>> parse_doubles(std::string_view content,
                                                 std::string_view separators = "");

}  // namespace sgs::io
