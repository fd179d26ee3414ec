// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "sgs/core/error.h"

namespace sgs::io {

/// A JSON file of another program: at most 64 MB and 32 levels deep, so that no file can ask for
/// more memory or stack than it is worth. Syntax errors name the place.
Result<nlohmann::json> load_json(const std::filesystem::path& path);

/// The same from text of a bounded size; `name` stands for the file's name in messages.
Result<nlohmann::json> parse_json(std::string_view content, const std::string& name);

/// What went wrong, without the name that the library puts before it.
std::string plain_words(const nlohmann::json::exception& error);

/// Calls `read`, which looks at a document of that file, and makes an error of a missing key or a
/// value of the wrong type; `needed` says what should be there.
template <class Read>
auto read_json(const std::filesystem::path& path, const char* needed, Read&& read)
    -> decltype(read()) {
  try {
    return read();
  } catch (const nlohmann::json::exception& e) {
    return fail(ErrorCode::kInvalidFormat, fmt::format("{}: {}", path.string(), plain_words(e)),
                fmt::format("needed: {}", needed));
  }
}

}  // namespace sgs::io
