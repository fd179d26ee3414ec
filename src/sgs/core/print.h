// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <string_view>
#include <utility>

#include "sgs/core/format.h"

namespace sgs {

/// Writes `text` to a stream. A terminal that is gone or a full disk behind it is no reason to
/// throw away what is being computed: failures are ignored here and found by close_stdout().
inline void write_text(std::FILE* stream, std::string_view text) {
  std::fwrite(text.data(), 1, text.size(), stream);
}

/// Results for standard output.
template <class... Args>
void print(fmt::format_string<Args...> format, Args&&... args) {
  write_text(stdout, fmt::format(format, std::forward<Args>(args)...));
}

/// Messages and progress for standard error.
template <class... Args>
void say(fmt::format_string<Args...> format, Args&&... args) {
  write_text(stderr, fmt::format(format, std::forward<Args>(args)...));
}

}  // namespace sgs
