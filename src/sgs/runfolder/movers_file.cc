// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/runfolder/movers_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <string_view>

#include "sgs/io/atomic_file.h"
#include "sgs/io/text.h"

namespace sgs::run {
namespace {

constexpr std::string_view kHead = "# index, squares of 8 pixels in which something moves\n";

std::string hexadecimal(std::string_view bytes) {
  std::string out;
  out.reserve(2 * bytes.size());
  for (const char byte : bytes) {
    constexpr std::string_view kDigits = "0123456789abcdef";
    const auto value = static_cast<unsigned char>(byte);
    out += kDigits[value >> 4];
    out += kDigits[value & 15];
  }
  return out;
}

std::optional<std::string> bytes_of(std::string_view digits) {
  if (digits.empty() || digits.size() % 2 != 0) return std::nullopt;
  std::string out;
  out.reserve(digits.size() / 2);
  for (std::size_t i = 0; i < digits.size(); i += 2) {
    unsigned value = 0;
    const char* end = digits.data() + i + 2;
    const auto [stopped, problem] = std::from_chars(digits.data() + i, end, value, 16);
    if (problem != std::errc() || stopped != end) return std::nullopt;
    out += static_cast<char>(value);
  }
  return out;
}

}  // namespace

std::string movers_text(const std::vector<slam::FrameRecord>& frames) {
  std::string out;
  for (const slam::FrameRecord& frame : frames) {
    if (frame.movers.empty()) continue;
    if (out.empty()) out = kHead;
    out += fmt::format("{} {}\n", frame.index, hexadecimal(frame.movers));
  }
  return out;
}

Status load_movers(const std::filesystem::path& path, std::vector<slam::FrameRecord>& frames) {
  SGS_ASSIGN_OR_RETURN(const std::string text, io::read_file(path));
  std::string_view rest = text;
  auto record = frames.begin();
  for (int line = 1; !rest.empty(); ++line) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    const std::string_view row = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (row.empty() || row.front() == '#') continue;
    const std::size_t gap = std::min(row.find(' '), row.size() - 1);
    std::int64_t index = 0;
    const auto read = std::from_chars(row.data(), row.data() + gap, index);
    auto blocks = bytes_of(row.substr(gap + 1));
    if (read.ec != std::errc() || read.ptr != row.data() + gap || !blocks) {
      return fail(ErrorCode::kInvalidFormat,
                  fmt::format("{}, line {}: not an index and squares", path.string(), line),
                  "without the file what moves is learnt like the rest");
    }
    while (record != frames.end() && record->index < index) ++record;
    if (record != frames.end() && record->index == index) record->movers = std::move(*blocks);
  }
  return {};
}

}  // namespace sgs::run
