// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace sgs {

/// Length of the UTF-8 sequence at the start of `text`; 0 when it is empty or not UTF-8.
std::size_t utf8_length(std::string_view text);
bool is_utf8(std::string_view text);

/// `text` as a TOML string in double quotes, control characters escaped. TOML holds nothing but
/// UTF-8: bytes that are not become U+FFFD, so check is_utf8() where the text must come back.
std::string toml_quoted(std::string_view text);

/// `text` with '?' for control characters and for bytes that are not UTF-8: names out of foreign
/// files may go to a terminal or into JSON.
std::string printable(std::string_view text);

/// `text`, cut where it would fill a terminal; for messages that quote what was typed.
std::string shortened(std::string_view text);

/// The one of `words` with the fewest typing errors to `word`; empty when there are no words.
std::string_view nearest_word(std::string_view word, std::span<const std::string_view> words);

/// Remedy for a word that is none of `allowed`: the nearest one, then all of them.
std::string allowed_words(std::string_view word, std::span<const std::string_view> allowed);

}  // namespace sgs
