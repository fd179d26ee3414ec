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

void append_utf8(std::string& out, char32_t c) {
  const auto tail = [&](int shift) { out += static_cast<char>(0x80 | (c >> shift & 0x3F)); };
  if (c < 0x80) {
    out += static_cast<char>(c);
  } else if (c < 0x800) {
    out += static_cast<char>(0xC0 | c >> 6);
    tail(0);
  } else if (c < 0x10000) {
    out += static_cast<char>(0xE0 | c >> 12);
    tail(6), tail(0);
  } else {
    out += static_cast<char>(0xF0 | c >> 18);
    tail(12), tail(6), tail(0);
  }
}

/// UTF-16 without its mark; half a pair of surrogates becomes U+FFFD.
std::string from_utf16(std::string_view bytes, bool big_endian) {
  const auto unit = [&](std::size_t at) {
    const auto a = static_cast<unsigned char>(bytes[at]);
    const auto b = static_cast<unsigned char>(bytes[at + 1]);
    return static_cast<char32_t>(big_endian ? a << 8 | b : b << 8 | a);
  };
  std::string out;
  for (std::size_t at = 0; at + 1 < bytes.size(); at += 2) {
    char32_t c = unit(at);
    if (c >= 0xD800 && c < 0xDC00 && at + 3 < bytes.size() && unit(at + 2) >= 0xDC00 &&
        unit(at + 2) < 0xE000) {
      c = 0x10000 + ((c - 0xD800) << 10) + (unit(at + 2) - 0xDC00);
      at += 2;
    } else if (c >= 0xD800 && c < 0xE000) {
      c = 0xFFFD;
    }
    append_utf8(out, c);
  }
  return out;
}

/// Whether text that begins without a mark is UTF-16 of Latin letters: every second byte is 0.
/// `high` is the place of those in each pair.
bool zeros_at(std::string_view bytes, std::size_t high) {
  constexpr std::size_t kLooked_bytes = 64;
  const std::size_t end = std::min(bytes.size(), kLooked_bytes) / 2 * 2;
  for (std::size_t at = 0; at < end; at += 2) {
    if (bytes[at + high] != 0 || bytes[at + 1 - high] == 0) return false;
  }
  return end > 2;
}

/// Lines that end as old Macs ended them, with a carriage return alone.
void end_lines_with_feeds(std::string& text) {
  for (std::size_t at = 0; (at = text.find('\r', at)) != std::string::npos; ++at) {
    if (at + 1 >= text.size() || text[at + 1] != '\n') text[at] = '\n';
  }
}

}  // namespace

Result<std::string> read_text(const std::filesystem::path& path, std::int64_t limit_bytes) {
  SGS_ASSIGN_OR_RETURN(std::string content, read_file(path, limit_bytes));
  return utf8_text(std::move(content));
}

std::string utf8_text(std::string content) {
  const std::string_view bytes = content;
  if (bytes.starts_with("\xFF\xFE")) {
    content = from_utf16(bytes.substr(2), false);
  } else if (bytes.starts_with("\xFE\xFF")) {
    content = from_utf16(bytes.substr(2), true);
  } else if (zeros_at(bytes, 1) || zeros_at(bytes, 0)) {
    content = from_utf16(bytes, zeros_at(bytes, 0));
  }
  end_lines_with_feeds(content);
  return content;
}

std::string lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  return text;
}

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

std::optional<double> parse_decimal(std::string_view text) {
  const auto comma = text.find(',');
  if (comma == std::string_view::npos || text.find('.') != std::string_view::npos) {
    return parse_double(text);
  }
  std::string with_point(text);
  with_point[comma] = '.';
  return parse_double(with_point);
}

std::vector<std::string_view> split_row(std::string_view text, std::size_t count) {
  auto fields = split_fields(text, ";");
  const bool commas_separate =
      fields.size() != count || std::any_of(fields.begin(), fields.end(),
                                            [](std::string_view f) { return f.ends_with(','); });
  return commas_separate ? split_fields(text, ",;") : fields;
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
