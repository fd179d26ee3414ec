// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/io/csv.h"

#include <algorithm>

namespace sgs::io {
namespace {

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  while (true) {
    const auto end = text.find(separator);
    parts.push_back(text.substr(0, end));
    if (end == std::string_view::npos) return parts;
    text.remove_prefix(end + 1);
  }
}

}  // namespace

Result<CsvTable> CsvTable::parse(std::string_view text, std::string_view source) {
  CsvTable table;
  table.source_ = source;
  int number = 0;
  for (std::string_view line : split(text, '\n')) {
    ++number;
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (line.empty()) continue;
    if (table.names_.empty()) {
      table.names_ = split(line, ',');
      continue;
    }
    const auto cells = static_cast<std::size_t>(std::count(line.begin(), line.end(), ',')) + 1;
    if (cells > table.names_.size()) {
      return fail(ErrorCode::kInvalidFormat,
                  fmt::format("{}: line {} has {} cells but there are {} columns", source, number,
                              cells, table.names_.size()),
                  "the file was changed after it was written");
    }
    table.lines_.push_back({number, line});
  }
  return table;
}

std::optional<std::size_t> CsvTable::column(std::string_view name) const {
  const auto found = std::find(names_.begin(), names_.end(), name);
  if (found == names_.end()) return std::nullopt;
  return static_cast<std::size_t>(found - names_.begin());
}

std::vector<std::string_view> CsvTable::row(std::size_t index) const {
  auto cells = split(lines_[index].text, ',');
  cells.resize(names_.size());
  return cells;
}

tl::unexpected<Error> CsvTable::bad_cell(std::size_t row, std::string_view column,
                                         std::string_view text, std::string_view expected) const {
  constexpr std::size_t kShown = 40;
  return fail(ErrorCode::kInvalidFormat,
              fmt::format("{}: line {}: '{}' in column '{}' is not {}", source_, lines_[row].number,
                          text.substr(0, kShown), column, expected),
              "the file was changed after it was written");
}

}  // namespace sgs::io
