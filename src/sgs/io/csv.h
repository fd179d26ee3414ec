// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sgs/core/error.h"

namespace sgs::io {

/// Comma-separated text whose first line names the columns; no quoting, blank lines are skipped.
/// Holds views: the text must outlive the table.
class CsvTable {
 public:
  /// A line with more cells than there are columns is an error; one with fewer ends early.
  /// `source` stands for the file's name in messages.
  static Result<CsvTable> parse(std::string_view text, std::string_view source);

  std::size_t rows() const { return lines_.size(); }
  /// Position of a column; empty where the table has none of that name.
  std::optional<std::size_t> column(std::string_view name) const;
  /// The cells of a row, as many as there are columns; those that the line lacks are empty.
  std::vector<std::string_view> row(std::size_t index) const;
  /// An error about a cell, which names file, line and column.
  tl::unexpected<Error> bad_cell(std::size_t row, std::string_view column, std::string_view text,
                                 std::string_view expected) const;

 private:
  struct Line {
    int number = 0;  ///< in the file, 1 = first
    std::string_view text;
  };
  std::string source_;
  std::vector<std::string_view> names_;
  std::vector<Line> lines_;
};

}  // namespace sgs::io
