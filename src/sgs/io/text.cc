// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/io/text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <string>
#include <system_error>

namespace sgs::io {
namespace {

constexpr std::string_view kSpace = " \t\r\v\f\n";

std::string_view trimmed(std::string_view text) {
  const auto begin = text.find_first_not_of(kSpace);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kSpace) - begin + 1);
}

}  // namespace

std::vector<TextLine> content_lines(std::string_view content) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (content.starts_with(kByteOrderMark)) content.remove_prefix(kByteOrderMark.size());
  std::vector<TextLine> lines;
  for (int number = 1; !content.empty(); ++number) {
    const auto end = content.find('\n');
    const std::string_view line = content.substr(0, end);
    const std::string_view text = trimmed(line.substr(0, line.find('#')));
    if (!text.empty()) lines.push_back({number, text});
    content.remove_prefix(end == std::string_view::npos ? content.size() : end + 1);
  }
  return lines;
}

std::vector<std::string_view> split_fields(std::string_view text, std::string_view separators) {
  const std::string stops = std::string(kSpace) + std::string(separators);
  std::vector<std::string_view> fields;
  for (std::size_t at = 0; (at = text.find_first_not_of(stops, at)) != std::string_view::npos;) {
    const std::size_t end = std::min(text.find_first_of(stops, at), text.size());
    fields.push_back(text.substr(at, end - at));
    at = end;
  }
  return fields;
}

std::optional<double> parse_double(std::string_view text) {
  if (text.size() > 1 && text.front() == '+' && text[1] != '-') text.remove_prefix(1);
  double value = 0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  if (result.ec != std::errc{} || result.ptr != text.data() + text.size()) return std::nullopt;
  return value;
}

std::optional<std::vector<double>> parse_doubles(std::string_view content,
                                                 std::string_view separators) {
  std::vector<double> numbers;
  for (const TextLine& line : content_lines(content)) {
    for (const std::string_view field : split_fields(line.text, separators)) {
      const auto value = parse_double(field);
      if (!value || !std::isfinite(*value)) return std::nullopt;
      numbers.push_back(*value);
    }
  }
  return numbers;
}

}  // namespace sgs::io
