// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "frame_table.h"

#include <charconv>
#include <limits>

namespace sgs::app {
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

Result<FrameTable> FrameTable::parse(std::string_view text, std::string_view source) {
  FrameTable table;
  std::vector<std::string_view> names;
  for (const std::string_view line : split(text, '\n')) {
    if (line.empty()) continue;
    const auto cells = split(line, ',');
    if (names.empty()) {
      names = cells;
      continue;
    }
    if (cells.size() > names.size()) {
      return fail(ErrorCode::kInvalidFormat,
                  fmt::format("{}: line {} has {} cells but there are {} columns", source,
                              table.rows_ + 2, cells.size(), names.size()),
                  "run the sequence again");
    }
    // Bad frames end their line early.
    for (std::size_t i = 0; i < names.size(); ++i) {
      table.columns_[std::string(names[i])].emplace_back(i < cells.size() ? cells[i] : "");
    }
    ++table.rows_;
  }
  return table;
}

std::vector<double> FrameTable::numbers(const std::string& name) const {
  std::vector<double> values(rows_, std::numeric_limits<double>::quiet_NaN());
  const auto column = columns_.find(name);
  if (column == columns_.end()) return values;
  for (std::size_t i = 0; i < rows_; ++i) {
    const std::string& cell = column->second[i];
    double value = 0;
    const auto result = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    if (result.ec == std::errc{}) values[i] = value;
  }
  return values;
}

std::vector<std::string> FrameTable::texts(const std::string& name) const {
  const auto column = columns_.find(name);
  return column == columns_.end() ? std::vector<std::string>(rows_) : column->second;
}

}  // namespace sgs::app
