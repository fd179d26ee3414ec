// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "sgs/core/error.h"

namespace sgs::app {

/// frames.csv read back: named columns of text cells.
class FrameTable {
 public:
  /// `source` stands for the file's name in messages.
  static Result<FrameTable> parse(std::string_view text, std::string_view source);

  std::size_t rows() const { return rows_; }
  /// A column as numbers, NaN where a cell is empty or no number; all NaN when it is missing.
  std::vector<double> numbers(const std::string& name) const;
  /// A column as text; all empty when it is missing.
  std::vector<std::string> texts(const std::string& name) const;

 private:
  std::map<std::string, std::vector<std::string>> columns_;
  std::size_t rows_ = 0;
};

}  // namespace sgs::app
