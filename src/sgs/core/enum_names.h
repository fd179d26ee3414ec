// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "sgs/core/error.h"
#include "sgs/core/text.h"

namespace sgs {

/// One value of an enum and the word for it in TOML, on the command line and in reports.
template <class E>
struct EnumName {
  E value;
  std::string_view name;
};

/// An enum that has words. They are declared once, beside the enum, and found by its namespace:
///
///     enum class InsertionMethod { kQuadtree, kGrid };
///     constexpr auto enum_names(InsertionMethod) {
///       using enum InsertionMethod;
///       return std::to_array<EnumName<InsertionMethod>>({{kQuadtree, "quadtree"},
///                                                        {kGrid, "grid"}});
///     }
template <class E>
concept NamedEnum = std::is_enum_v<E> && requires(E value) {
  enum_names(value);
};

/// The words of an enum in the order of their declaration.
template <NamedEnum E>
std::vector<std::string_view> enum_words() {
  std::vector<std::string_view> words;
  for (const auto& entry : enum_names(E{})) words.push_back(entry.name);
  return words;
}

/// The word for `value`; "?" when it is none of the declared ones.
template <NamedEnum E>
std::string to_string(E value) {
  for (const auto& entry : enum_names(value)) {
    if (entry.value == value) return std::string(entry.name);
  }
  return "?";
}

/// The value for `word`. An unknown one is an error that says `what` was asked for, the nearest
/// word and all that are allowed.
template <NamedEnum E>
Result<E> from_string(std::string_view what, std::string_view word) {
  for (const auto& entry : enum_names(E{})) {
    if (entry.name == word) return entry.value;
  }
  return fail(ErrorCode::kInvalidArgument, fmt::format("unknown {} '{}'", what, shortened(word)),
              allowed_words(word, enum_words<E>()));
}

}  // namespace sgs
