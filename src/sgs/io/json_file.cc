// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#include "sgs/io/json_file.h"

#include "sgs/io/atomic_file.h"
#include "sgs/io/text.h"

namespace sgs::io {

Result<nlohmann::json> load_json(const std::filesystem::path& path) {
  constexpr std::int64_t kLargest_bytes = std::int64_t{64} << 20;
  SGS_ASSIGN_OR_RETURN(const std::string content, read_text(path, kLargest_bytes));
  return parse_json(content, path.string());
}

Result<nlohmann::json> parse_json(std::string_view content, const std::string& name) {
  constexpr int kDeepest = 32;
  struct TooDeep {};
  const auto look = [](int depth, nlohmann::json::parse_event_t, nlohmann::json&) {
    if (depth > kDeepest) throw TooDeep();
    return true;
  };
  try {
    return nlohmann::json::parse(content, look);
  } catch (const nlohmann::json::exception& e) {
    return fail(ErrorCode::kInvalidFormat, fmt::format("{}: {}", name, plain_words(e)),
                "write it again; it must be JSON");
  } catch (const TooDeep&) {
    return fail(ErrorCode::kInvalidFormat,
                fmt::format("{}: nested more than {} levels deep", name, kDeepest),
                "it does not describe a recording");
  }
}

std::string plain_words(const nlohmann::json::exception& error) {
  const std::string_view what = error.what();
  const auto end = what.find("] ");
  return std::string(what.starts_with('[') && end != what.npos ? what.substr(end + 2) : what);
}

}  // namespace sgs::io
